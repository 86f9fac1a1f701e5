"""Variables of the controller that the driver reads and writes: KUKA's own, and those of the programs shipped."""

from enum import IntEnum
from typing import Final

AXIS_ACT: Final = "$AXIS_ACT"
AXIS_MEASURED: Final = "$AXIS_ACT_MEAS"
OVERRIDE: Final = "$OV_PRO"
MODE: Final = "$MODE_OP"
PROGRAM_STATE: Final = "$PRO_STATE"
MODEL: Final = "$MODEL_NAME[]"
SERIAL: Final = "$KR_SERIALNO"
TORQUES: Final = tuple(f"$TORQUE_AXIS_ACT[{number}]" for number in range(1, 7))

VERSION: Final = "CATS_VERSION"
SEQUENCE: Final = "CATS_SEQ"
PREPARED: Final = "CATS_FOR"
COMMAND: Final = "CATS_CMD"
AXIS: Final = "CATS_AXIS"
INCREMENT: Final = "CATS_INC"
LINE: Final = ("CATS_X", "CATS_Y", "CATS_Z")
GOAL: Final = "CATS_GOAL"
STOP: Final = "CATS_STOP"
BEAT: Final = "CATS_BEAT"
TAKEN: Final = "CATS_TAKEN"
DONE: Final = "CATS_DONE"
RESULT: Final = "CATS_RESULT"
MOVING: Final = "CATS_MOVING"
MOST_DEG: Final = "CATS_MAX_DEG"
MOST_MM: Final = "CATS_MAX_MM"

PROGRAM: Final = "CATSKUKA"
"""Name of the program that carries out orders."""

PROGRAM_VERSION: Final = 3
"""Of CATSKUKA and CATSVARS as they are shipped with this driver."""

ACTIVE: Final = "P_ACTIVE"


class Command(IntEnum):
    """What an order asks for."""

    AXES = 1
    STEP_AXIS = 2
    STEP_LINE = 3
    STEP_TO = 4


class Result(IntEnum):
    """What became of an order."""

    DONE = 0
    UNDER_WAY = 1
    STOPPED = 2
    NO_HEARTBEAT = 3
    STOP_STANDS = 4
    NOT_PREPARED = 5
    TOO_LARGE = 6
    UNKNOWN = 7
