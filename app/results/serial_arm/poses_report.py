"""Targets at poses: where they were measured, and how far from where the drawn arm has them."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from catseye.app.cell.arm import arm_description
from catseye.app.cell.serial_arm import chain_of
from catseye.app.files.tabular import Row
from catseye.app.results.figures import Axis, Figure, Line, Panel, Points, Role
from catseye.app.results.model import Bullets, Column, Section, Sign, Statement, Table, section
from catseye.app.results.numbers import COUNT, counted, fixed, number
from catseye.app.results.runs.run_source import cell_of_run
from catseye.app.results.serial_arm.figures import histograms
from catseye.app.results.serial_arm.pose_places import places_figure
from catseye.app.results.serial_arm.run_poses import has_pose_targets, pose_rows
from catseye.app.store.reader import RunReader
from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.closed_form import rigid_motion

_PLACE: Final = ("x_mm", "y_mm", "z_mm")
_ARROW_MM: Final = 60.0
"""Length of the longest arrow on the drawing."""

_ABOUT: Final = (
    "Difference: measured place less that of the arm and tool as drawn, after the best frame of the instrument "
    "alone. It shows what there is to calibrate, and poses that do not fit the others; it is not an accuracy.",
)

_COLUMNS: Final = (
    Column("target", "target"),
    Column("measured", "measured", "", COUNT),
    Column("mean_mm", "mean difference", "mm", fixed(3)),
    Column("max_mm", "largest", "mm", fixed(3)),
)


def poses_section(reader: RunReader) -> Section:
    """Return what a run has measured of targets at poses against the drawn arm; nothing of another run."""
    places = places_figure(reader)
    if not has_pose_targets(reader):
        return section("poses", "Poses", [places], brief=True)
    rows = pose_rows(reader)
    names = [str(row["target"]) for row in rows]
    drawn = _drawn_mm(reader, rows)
    seen = np.array([[row[name] for name in _PLACE] for row in rows], dtype=np.float64)
    try:
        frame = rigid_motion(seen, drawn)
    except InsufficientPointsError:
        return section("poses", "Poses", [_table(names, None), places], brief=True)
    away = seen @ frame[:3, :3].T + frame[:3, 3] - drawn
    size = np.linalg.norm(away, axis=1)
    figures = [
        places,
        _arrows(drawn, away, size),
        histograms("pose-differences", "Differences", [("as drawn", size)]),
    ]
    blocks = [_said(size), _table(names, size), Bullets("", _ABOUT), *figures]
    return section("poses", "Poses", blocks, brief=True)


def _said(size_mm: Floats) -> Statement:
    mean = f"{number(float(size_mm.mean()), fixed(3))} mm"
    most = f"{number(float(size_mm.max()), fixed(3))} mm"
    text = (
        f"{counted(len(size_mm), 'target')} at poses, {mean} from the drawn arm on average, {most} at most."
    )
    return Statement(Sign.NEUTRAL, text, f"{mean} from nominal")


def _drawn_mm(reader: RunReader, rows: Sequence[Row]) -> Floats:
    """Return where the drawn arm has the targets at the commanded joints, in the frame of its base, shape (n, 3)."""
    cell = cell_of_run(reader)
    description = arm_description(cell.robot.arm)
    keys = [f"q{number}_{joint.unit}" for number, joint in enumerate(description.joint, 1)]
    poses = np.array([[row[key] for key in keys] for row in rows], dtype=np.float64)
    tool = cell.robot.carried
    of_flange = {one.name: (one.x_mm, one.y_mm, one.z_mm) for one in tool.target} if tool is not None else {}
    # The frame of an optical CMM's plate has no place in the tool's file: that of the flange stands for it.
    places = np.array([(*of_flange.get(str(row["target"]), (0.0, 0.0, 0.0)), 1.0) for row in rows])
    return np.asarray(np.einsum("nij,nj->ni", chain_of(description).flange(poses), places)[:, :3])


def _table(names: Sequence[str], size_mm: Floats | None) -> Table:
    found = np.array(names)
    rows = []
    for name in dict.fromkeys(names):
        of_it = found == name
        values = (
            (None, None) if size_mm is None else (float(size_mm[of_it].mean()), float(size_mm[of_it].max()))
        )
        rows.append((name, int(of_it.sum()), *values))
    return Table("poses", "Targets at poses", _COLUMNS, tuple(rows))


def _arrows(drawn_mm: Floats, away_mm: Floats, size_mm: Floats) -> Figure:
    """Return an arrow for each target, from above and from the side, the longest of a stated length."""
    scale = _ARROW_MM / max(float(size_mm.max()), 1e-9)
    views = (("from above", 0, 1), ("from the side", 0, 2))
    panels = []
    for title, i, j in views:
        start, end = drawn_mm, drawn_mm + scale * away_mm
        # A third place breaks the line between two arrows.
        gap = np.full(len(start), np.nan)
        x = np.column_stack([start[:, i], end[:, i], gap]).ravel()
        y = np.column_stack([start[:, j], end[:, j], gap]).ravel()
        heads = Points(
            end[:, i], end[:, j], Role.SCATTER, size=3.0, value=size_mm, value_label="difference / mm"
        )
        panels.append(
            Panel(
                title,
                Axis(f"{'xyz'[i]} / mm"),
                Axis(f"{'xyz'[j]} / mm"),
                (Line(x, y, Role.MUTED, width=0.8), heads),
                equal=True,
            )
        )
    caption = f"Differences to the drawn arm, {scale:.0f} times as long; the point is the arrow's head."
    return Figure("pose-arrows", "Differences at poses", caption, (tuple(panels),))
