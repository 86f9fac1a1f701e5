"""Values of a cell file that are possible and hardly meant: a slip of a unit or of a digit, as a rule."""

import math
from collections.abc import Iterator

from catseye.app.cell.arm import shipped_arm
from catseye.app.cell.model import Cell

_LONGEST_WAIT_S = 30.0
_LONGEST_REACH_MM = 2000.0
_SAME_LINK_MM = 5.0
_LARGEST_TAKE_UP_DEG = 10.0
_LARGEST_SPREAD_UM = 1000.0
_SAME_COLUMN_MM = 1.0
_LONGEST_RUN_DAYS = 2.0


def implausible(cell: Cell) -> list[str]:
    """Return what is hardly meant, each with the key, the value and what would be usual."""
    return [*_arm(cell), *_timing(cell), *_places(cell)]


def _arm(cell: Cell) -> Iterator[str]:
    robot, description = cell.robot, shipped_arm(cell.robot.arm)
    links = {"link1_mm": (robot.link1_mm, "J2"), "link2_mm": (robot.link2_mm, "J3")}
    nominal = {joint.name: joint.a_mm for joint in description.joint}
    for key, (length_mm, joint) in links.items():
        if abs(length_mm - nominal[joint]) > _SAME_LINK_MM:
            yield f"robot.{key} = {length_mm:g}: the {description.name} has {nominal[joint]:g} mm"
    reach_mm = robot.link1_mm + robot.link2_mm
    if reach_mm > _LONGEST_REACH_MM:
        yield (
            f"robot.link1_mm + robot.link2_mm = {reach_mm:g}: a reach of {reach_mm / 1000.0:g} m is no SCARA's; "
            "are both in mm?"
        )
    columns = [body.radius_mm for body in (*cell.body, *description.body) if body.name == "base column"]
    if columns and abs(columns[0] - cell.optics.column_radius_mm) > _SAME_COLUMN_MM:
        yield (
            f"optics.column_radius_mm = {cell.optics.column_radius_mm:g} and the body base column has "
            f"{columns[0]:g} mm: they are the same column, seen by the beam and by the arm"
        )


def _timing(cell: Cell) -> Iterator[str]:
    timing = cell.measurement
    for key in ("settle_time_s", "dwell_time_s"):
        value_s = getattr(timing, key)
        if value_s > _LONGEST_WAIT_S:
            yield f"measurement.{key} = {value_s:g}: seconds at each point; usual are 0.2 … 5"
    points = 4 * len(timing.theta1_deg) * len(timing.theta2_deg) * len(cell.reflector)
    days = points * (timing.settle_time_s + timing.dwell_time_s) / 86_400.0
    if days > _LONGEST_RUN_DAYS:
        yield f"[measurement] waits for {days:.1f} days at {points} points: fewer nodes, or shorter times?"
    if timing.take_up_deg > _LARGEST_TAKE_UP_DEG:
        yield f"measurement.take_up_deg = {timing.take_up_deg:g}: usual are 0.5 … 2 deg"
    if timing.spread_limit_um > _LARGEST_SPREAD_UM:
        yield f"measurement.spread_limit_um = {timing.spread_limit_um:g}: readings that scatter by a mm; usual are 5"


def _places(cell: Cell) -> Iterator[str]:
    optics = cell.optics
    reach_mm = cell.robot.link1_mm + cell.robot.link2_mm
    for reflector in cell.reflector:
        away_mm = math.hypot(reflector.x_mm, reflector.y_mm)
        if away_mm > reach_mm + optics.beam_max_mm:
            yield (
                f"reflector {reflector.name} is {away_mm / 1000.0:.1f} m from the J1 axis: no pose brings it within "
                f"optics.beam_max_mm = {optics.beam_max_mm:g}"
            )
        elif away_mm < optics.column_radius_mm:
            yield f"reflector {reflector.name} stands inside the base column"
