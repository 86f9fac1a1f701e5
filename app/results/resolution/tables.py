"""What the files of a test hold: recordings, moves, joint torques."""

from typing import Final

from catseye.procedures.kit.columns import ColumnRule, TableRule

_TIME: Final = ColumnRule("t_s", unit="s")
_SWAPPED: Final = "stands in moves and in no recording: check whether --recording and --moves are swapped"

RECORDING: Final = TableRule(
    holds="samples",
    row="one sample",
    forms=(
        (_TIME, ColumnRule("angle_deg", unit="deg")),
        (_TIME, ColumnRule("displacement_mm", unit="mm")),
    ),
    mixed="a recording holds displacements of the optics or angles, not both",
    misplaced=(("command_deg", f"command_deg {_SWAPPED}"), ("command_mm", f"command_mm {_SWAPPED}")),
)

MOVES: Final = TableRule(
    holds="moves",
    row="one commanded move",
    forms=(
        (_TIME, ColumnRule("command_mm", unit="mm")),
        (_TIME, ColumnRule("command_deg", unit="deg")),
    ),
    mixed="moves are in mm or in deg, not both",
    misplaced=tuple(
        (
            name,
            f"{name} stands in a recording and in no moves: check whether --recording and --moves are swapped",
        )
        for name in ("displacement_mm", "angle_deg")
    ),
)

TORQUE: Final = TableRule(
    holds="torques", row="the motor torque at one time", forms=((_TIME, ColumnRule("torque_nm", unit="N m")),)
)
