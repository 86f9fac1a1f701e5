"""Where the arm goes, how far, for how long and how fast: what stands before every key that lets it move."""

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from catseye.app.results.numbers import duration_text, listed
from catseye.app.results.rehearsal import brief_text
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.jog_text import cap_percent, fresh_joints
from catseye.app.tui.widgets.status_bar import override_text
from catseye.drivers.roles.pose import SYMBOLS

if TYPE_CHECKING:
    # The first screen is painted before these are imported.
    from catseye.app.protocol.bench import AxisRange
    from catseye.app.protocol.rehearsal import Rehearsal
    from catseye.app.protocol.scara.layout import Layout

_NAME_CELLS: Final = 11
_CELLS: Final = 61
"""Room in the narrowest dialog before a motion."""

_STANDS: Final = 0.005
"""Who moves by less, deg or mm, stands there."""

_AXES_NAMED: Final = 8


def row(name: str, text: str) -> str:
    """Return a line of a dialog before a motion, or several under each other."""
    return textwrap.fill(
        f"{name:<{_NAME_CELLS}}{text}",
        _CELLS,
        subsequent_indent=" " * _NAME_CELLS,
        break_on_hyphens=False,
        break_long_words=False,
    )


def way_rows(
    engine: EngineState, target: Sequence[float], now_s: float, percent: float | None = None
) -> list[str]:
    """Return a target, how far it is from where the arm stands now, and for how long the arm drives there.

    Args:
        target: one value an axis, deg or mm.
        now_s: monotonic time, s.
        percent: speed override of the motion; that of now without it.
    """
    axes = () if engine.bench is None else engine.bench.axes
    rows = [row("target", ", ".join(axis.text(value) for axis, value in zip(axes, target, strict=False)))]
    if engine.layout is not None:
        x_mm, y_mm = _place_mm(engine.layout, target)
        rows.append(row("", f"x {x_mm:z.1f} mm, y {y_mm:z.1f} mm"))
    moved, place, time = _distance(engine, target, now_s, percent)
    rows += [row("distance", moved), *([row("", place)] if place else [])]
    return [*rows, row("time", time)] if time else rows


def distance_text(
    engine: EngineState, target: Sequence[float], now_s: float, percent: float | None = None
) -> str:
    """Return in a line how far a target is from where the arm stands now, and for how long the arm drives there.

    Args:
        target: one value an axis, deg or mm.
        now_s: monotonic time, s.
        percent: speed override of the motion; that of now without it.
    """
    return "; ".join(part for part in _distance(engine, target, now_s, percent) if part)


def speed_rows(engine: EngineState, percent: float | None = None) -> list[str]:
    """Return the speed override, the cell's highest, and how fast the axes can be at it.

    Args:
        percent: of the motion; that of now without it.
    """
    robot = engine.robot
    if robot is None:
        return [row("override", "not known; the engine keeps it at the cell's cap at most")]
    shown = override_text(robot) if percent is None else f"{percent:g} %"
    rows = [row("override", f"{shown}, at most {robot.override_cap_percent:g} %")]
    used = _percent(engine) if percent is None else percent
    axes = () if engine.bench is None else engine.bench.axes
    speeds = [
        f"{axis.name} {axis.speed * used / 100.0:.3g} {axis.unit}/s" for axis in axes if axis.speed and used
    ]
    return [*rows, row("speed", f"at most {listed(speeds, _AXES_NAMED)}")] if speeds else rows


def rehearsed_row(rehearsal: "Rehearsal | None") -> str:
    """Return whether motions were rehearsed, and what was found."""
    return row("rehearsed", "no" if rehearsal is None else f"yes: {brief_text(rehearsal)}")


def _distance(
    engine: EngineState, target: Sequence[float], now_s: float, percent: float | None
) -> tuple[str, str, str]:
    """Return by how much each axis moves, by how much the tool does, and for how long; empty what nobody knows."""
    here, axes = fresh_joints(engine, now_s), () if engine.bench is None else engine.bench.axes
    if here is None or not len(here) == len(target) == len(axes):
        return "not known: the arm's position is not up to date", "", ""
    travels = [abs(to - at) for at, to in zip(here, target, strict=True)]
    moved = [
        f"{axis.name} by {travel:.2f}{SYMBOLS[axis.unit]}"
        for axis, travel in zip(axes, travels, strict=True)
        if travel >= _STANDS
    ]
    if not moved:
        return "none: the arm is there already", "", ""
    place = ""
    if engine.layout is not None:
        (x_mm, y_mm), (to_x_mm, to_y_mm) = _place_mm(engine.layout, here), _place_mm(engine.layout, target)
        place = f"{((to_x_mm - x_mm) ** 2 + (to_y_mm - y_mm) ** 2) ** 0.5:.1f} mm in x and y"
    time_s = _time_s(axes, travels, _percent(engine) if percent is None else percent)
    return ", ".join(moved), place, "" if time_s is None else f"about {duration_text(time_s)}"


def _percent(engine: EngineState) -> float | None:
    """Return the override at which the next motion is driven: the engine lowers one that is too high."""
    now = None if engine.robot is None else engine.robot.override_percent
    return None if now is None else min(now, cap_percent(engine))


def _time_s(axes: "Sequence[AxisRange]", travels: Sequence[float], percent: float | None) -> float | None:
    """Return how long the slowest axis takes; None where its speed is not known."""
    times_s = [
        travel / axis.speed for axis, travel in zip(axes, travels, strict=True) if axis.speed is not None
    ]
    return 100.0 * max(times_s) / percent if percent and len(times_s) == len(axes) else None


def _place_mm(layout: "Layout", joints: Sequence[float]) -> tuple[float, float]:
    from catseye.app.tui.scara.plan_drawing import pose_of

    return pose_of(layout, joints).place_mm
