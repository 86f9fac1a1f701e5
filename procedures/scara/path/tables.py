"""Files that are given to a path: what shall be driven, what an instrument measured, corrected commands."""

from dataclasses import replace

from catseye.procedures.kit.columns import ColumnRule, TableRule
from catseye.procedures.scara.path.segments import DrawnPath

_STATES = "joint commands need the state of approach of each joint, 1 or -1"

JOINTS = (ColumnRule("theta1_deg", unit="deg"), ColumnRule("theta2_deg", unit="deg"))
DIRECTIONS = (
    ColumnRule("direction1", "direction", needed=_STATES),
    ColumnRule("direction2", "direction", needed=_STATES),
)
PLACE = (ColumnRule("x_mm", unit="mm"), ColumnRule("y_mm", unit="mm"))

LINE = ColumnRule("line", "integer", optional=True)
"""Which of several lines of a path a row belongs to."""

_TOOL = (
    LINE,
    ColumnRule("z_mm", unit="mm", optional=True),
    ColumnRule("c_deg", unit="deg", optional=True),
    ColumnRule("speed_mm_s", unit="mm/s", optional=True, positive=True),
)

COMMAND_FORMS = ((*JOINTS, *DIRECTIONS), PLACE)
"""Commands of a path: joints with their states of approach, or positions."""

TWO_FORMS = "joint and Cartesian commands stand in one file"

PATH = TableRule(
    "commands",
    "one",
    tuple((*form, *_TOOL) for form in COMMAND_FORMS),
    mixed=TWO_FORMS,
    drawing=DrawnPath,
)
"""Path files: what shall be driven, in one line or several; height and orientation of the tool are kept."""

_MEASURED = (
    ColumnRule("x_meas_mm", unit="mm"),
    ColumnRule("y_meas_mm", unit="mm"),
    # An instrument with a larger uncertainty would say nothing about an error map.
    ColumnRule(
        "u_mm",
        unit="mm",
        optional=True,
        positive=True,
        largest=1.0,
        hint="it seems to be in µm; convert it to mm, or leave the column out",
    ),
)

WISHED = (
    ColumnRule("x_wished_mm", unit="mm", optional=True),
    ColumnRule("y_wished_mm", unit="mm", optional=True),
)
"""Where a corrected joint command shall bring the arm; without it, where it would bring the nominal arm."""

MEASURED = TableRule(
    "points",
    "one position",
    ((*COMMAND_FORMS[0], *_MEASURED, *_TOOL, *WISHED), (*COMMAND_FORMS[1], *_MEASURED, *_TOOL)),
    mixed=TWO_FORMS,
    misplaced=(
        (
            "displacement_mm",
            "the file holds distances to reflectors, and positions are needed: x_meas_mm, y_meas_mm. A path of "
            "distances is compared by catseye report on its run of validation-path",
        ),
    ),
)
"""Where an independent instrument saw the arm along a path (version 1)."""

_UNSOLVED = "has no corrected command: take the row out of the path, and compensate it again"

JOINT_ROWS = TableRule(
    "rows",
    "one",
    (
        (
            *PLACE,
            *(replace(joint, empty=_UNSOLVED) for joint in JOINTS),
            *DIRECTIONS,
            LINE,
            ColumnRule("j3_mm", unit="mm", optional=True),
            ColumnRule("j4_deg", unit="deg", optional=True),
        ),
    ),
    source="the CSV that catseye compensate writes",
)
"""Rows to be driven as they stand; take-ups follow from them."""
