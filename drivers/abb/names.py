"""Resources of the controller and persistent data of the module CATSABB that the driver reads and writes."""

from enum import IntEnum
from typing import Final

from catseye.drivers.abb.http import Request

JSON: Final = ("json", "1")

MODULE: Final = "CATSABB"
MODULE_VERSION: Final = 1
"""Of CATSABB.mod as it is shipped with this driver."""

VERSION: Final = "cats_version"
SEQUENCE: Final = "cats_seq"
PREPARED: Final = "cats_for"
GOAL: Final = "cats_goal"
BEAT: Final = "cats_beat"
TAKEN: Final = "cats_taken"
DONE: Final = "cats_done"
RESULT: Final = "cats_result"

LARGEST_NUMBER: Final = 999_999
"""Of an order: a num of 32 bits counts further, but its text may have six digits only."""

RUNNING: Final = "running"
MOTORS_ON: Final = "motoron"
MOTORS_OFF: Final = "motoroff"
EMERGENCY: Final = frozenset({"emergencystop", "emergencystopreset"})
AUTO: Final = "AUTO"
MANUAL: Final = frozenset({"MANR", "MANF", "MANF_CH"})


class Result(IntEnum):
    """What became of an order."""

    DONE = 0
    UNDER_WAY = 1
    NOT_PREPARED = 2
    NO_HEARTBEAT = 3


def reading(path: str) -> Request:
    """Return the question for a resource."""
    return Request("GET", path, (JSON,))


def doing(path: str, action: str, **form: str) -> Request:
    """Return what has a resource do something; a name with _ has - in the form."""
    pairs = tuple((name.replace("_", "-"), value) for name, value in form.items())
    return Request("POST", path, (("action", action), JSON), pairs)


CONTROL_STATE: Final = reading("rw/panel/ctrlstate")
MODE: Final = reading("rw/panel/opmode")
SPEED_RATIO: Final = reading("rw/panel/speedratio")
EXECUTION: Final = reading("rw/rapid/execution")
SYSTEM: Final = reading("rw/system")
LOGOUT: Final = reading("logout")

STOP: Final = doing("rw/rapid/execution", "stop", stopmode="stop")
"""What stops the arm: RAPID stops, and with it the motion under way, on its path."""

RESET: Final = doing("rw/rapid/execution", "resetpp")
START: Final = doing(
    "rw/rapid/execution",
    "start",
    regain="continue",
    execmode="continue",
    cycle="asis",
    condition="none",
    stopatbp="disabled",
    alltaskbytsp="true",
)
REQUEST_MASTERSHIP: Final = doing("rw/mastership/rapid", "request")
RELEASE_MASTERSHIP: Final = doing("rw/mastership/rapid", "release")


def joint_target(unit: str) -> Request:
    """Return the question for the joints of a mechanical unit."""
    return reading(f"rw/motionsystem/mechunits/{unit}/jointtarget")


def data(task: str, name: str) -> Request:
    """Return the question for persistent data of the module."""
    return reading(f"rw/rapid/symbol/data/RAPID/{task}/{MODULE}/{name}")


def data_set(task: str, name: str, text: str) -> Request:
    """Return what gives persistent data of the module a value."""
    return doing(f"rw/rapid/symbol/data/RAPID/{task}/{MODULE}/{name}", "set", value=text)


def main_search(task: str) -> Request:
    """Return the question where the procedure main of a task stands."""
    return doing(
        "rw/rapid/symbols",
        "search-symbols",
        view="block",
        vartyp="any",
        blockurl=f"RAPID/{task}",
        symtyp="prc",
        recursive="true",
        skipshared="FALSE",
        onlyused="FALSE",
        stack="0",
        posl="0",
        posc="0",
        regexp="^main$",
    )
