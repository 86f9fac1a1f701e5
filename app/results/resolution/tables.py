"""What the files of a test hold: recordings, moves, joint torques."""

from typing import Final

from catseye.procedures.kit.columns import ColumnRule, TableRule

_TIME: Final = ColumnRule("t_s", unit="s")
_SEQUENCE: Final = ColumnRule("sequence", "integer", optional=True)
"""Of a test that goes there and back, from 1; 0 for moves that only lead to its beginning."""

_SWAPPED: Final = "stands in moves and in no recording: check whether --recording and --moves are swapped"

RECORDING: Final = TableRule(
    holds="samples",
    row="one sample",
    forms=(
        (_TIME, ColumnRule("angle_deg", unit="deg")),
        (_TIME, ColumnRule("displacement_mm", unit="mm")),
    ),
    mixed="a recording holds displacements of the optics or angles, not both",
    source="a recording, with the columns t_s and displacement_mm or angle_deg",
    misplaced=(("command_deg", f"command_deg {_SWAPPED}"), ("command_mm", f"command_mm {_SWAPPED}")),
)

MOVES: Final = TableRule(
    holds="moves",
    row="one commanded move",
    forms=(
        (_TIME, ColumnRule("command_mm", unit="mm"), _SEQUENCE),
        (_TIME, ColumnRule("command_deg", unit="deg"), _SEQUENCE),
    ),
    mixed="moves are in mm or in deg, not both",
    source="moves, with the columns t_s and command_deg or command_mm",
    misplaced=tuple(
        (
            name,
            f"{name} stands in a recording and in no moves: check whether --recording and --moves are swapped",
        )
        for name in ("displacement_mm", "angle_deg")
    ),
)

TORQUE: Final = TableRule(
    holds="torques",
    row="the motor torque at one time",
    forms=((_TIME, ColumnRule("torque_nm", unit="N m")),),
    source="a joint torque, with the columns t_s and torque_nm",
)
