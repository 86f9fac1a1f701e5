"""What single joints do beside turning: Table III and Figures 5 and 6 of the six-axis paper, from a run."""

from collections.abc import Sequence
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from catseye.app.results.figures import Axis, Figure, Level, Panel, Points, Role
from catseye.app.results.model import Block, Bullets, Cell, Column, Section, Sign, Statement, Table, section
from catseye.app.results.numbers import COUNT, fixed, number
from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.circles import AxisErrors
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.stored import number_of, numbers_of
from catseye.procedures.serial_arm.axis_analysis import STEP, errors_about_axis
from catseye.procedures.serial_arm.records import MeasuredTarget

_MM = fixed(3)
_DEG = fixed(4)
_ROW_ASPECT = 0.35

_ABOUT = (
    "Errors count from the place nearest to 0° of the joint, or to the middle of what it shows, against a circle "
    "about the axis through that place.",
    "Tangential: along the circle, the range over both ways. Angular: the same seen from the axis. Backlash: angle "
    "after coming from below less that after coming from above, mean over the places.",
)

_COLUMNS = (
    Column("joint", "joint"),
    Column("target", "target"),
    Column("low_deg", "from", "deg", fixed(1)),
    Column("high_deg", "to", "deg", fixed(1)),
    Column("radius_mm", "radius", "mm", _MM),
    Column("tangential_range_mm", "tangential range", "mm", _MM),
    Column("angular_range_deg", "angular range", "deg", _DEG),
    Column("backlash_deg", "mean backlash", "deg", fixed(4, signed=True)),
    Column("radial_std_mm", "radial std", "mm", _MM),
    Column("axial_std_mm", "axial std", "mm", _MM),
    Column("hidden", "hidden", "", COUNT),
)


def axis_section(reader: RunReader) -> Section:
    """Return Table III of a run of axis-analysis, and its errors by joint; nothing of another run."""
    steps = {step.step_id: step.result for step in reader.steps() if step.step_id.startswith(STEP)}
    if not steps:
        return section("axes", "Single axes", [])
    joints = [str(row["joint"]) for row in steps.values()]
    found = [_errors(reader, step_id) for step_id in steps]
    rows = tuple(_line(row) for row in steps.values())
    figures = [_figure("tangential", joints, found), _figure("angular", joints, found)]
    table = Table("axes", "Errors of single axes", _COLUMNS, rows)
    blocks: list[Block] = [_said(list(steps.values())), table, Bullets("", _ABOUT), *figures]
    return section("axes", "Single axes", blocks, brief=True)


def _said(rows: Sequence[Row]) -> Statement:
    """Return the joints with the largest tangential error and backlash."""
    tangential = max(rows, key=lambda row: number_of(row, "tangential_range_mm"))
    backlash = max(rows, key=lambda row: abs(number_of(row, "backlash_deg")))
    range_mm = number(number_of(tangential, "tangential_range_mm"), _MM)
    play_deg = number(number_of(backlash, "backlash_deg"), fixed(4, signed=True))
    text = (
        f"Tangential error over {range_mm} mm at most, of {tangential['joint']}; "
        f"backlash {play_deg}° at most, of {backlash['joint']}."
    )
    return Statement(Sign.NEUTRAL, text, f"tangential ≤ {range_mm} mm")


def _line(row: Row) -> tuple[Cell, ...]:
    hidden = row["hidden"]
    values = {**row, "hidden": len(hidden) if isinstance(hidden, list) else 0}
    found = (values[column.key] for column in _COLUMNS)
    return tuple(value if isinstance(value, str | int | float) else None for value in found)


_Seen = tuple[Floats, NDArray[np.bool_], AxisErrors]
"""Commands of the joint, whether it came from below, and its errors."""


def _errors(reader: RunReader, step_id: str) -> _Seen:
    rows = [row for row in reader.rows(MeasuredTarget.table) if row["step_id"] == step_id]
    poses = np.array([numbers_of(row, "q") for row in rows])
    command_deg = poses[:, int(np.argmax(np.ptp(poses, axis=0)))]
    # The way back begins with the place at which the way there ends.
    from_below = np.diff(command_deg, prepend=-np.inf) > 0.0
    places = np.array([[number_of(row, name) for name in ("x_mm", "y_mm", "z_mm")] for row in rows])
    return command_deg, from_below, errors_about_axis(command_deg, places, from_below)


def _figure(kind: Literal["tangential", "angular"], joints: Sequence[str], seen: Sequence[_Seen]) -> Figure:
    """Return an error against the joint's command, a panel a joint, two in a row, both ways in it."""
    unit = "mm" if kind == "tangential" else "deg"
    panels = []
    for joint, (command_deg, from_below, errors) in zip(joints, seen, strict=True):
        values = errors.tangential_mm if kind == "tangential" else errors.angular_deg
        marks = tuple(
            Points(command_deg[way], values[way], role, label, joined=True, size=3.0)
            for way, role, label in (
                (from_below, Role.POSITIVE, "from below"),
                (~from_below, Role.NEGATIVE, "from above"),
            )
        )
        panels.append(
            Panel(joint, Axis("command / deg"), Axis(f"error / {unit}"), (*marks, Level(0.0, Role.AXIS)))
        )
    rows = tuple(
        (panels[first], panels[first + 1] if first + 1 < len(panels) else None)
        for first in range(0, len(panels), 2)
    )
    title = f"{kind.capitalize()} error by joint"
    caption = f"{title}, coming from below and from above."
    return Figure(f"axis-{kind}", title, caption, rows, aspect=_ROW_ASPECT * len(rows))
