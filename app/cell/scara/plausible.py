"""Values of a SCARA and of open-loop tracking that are possible and hardly meant."""

import math
from collections.abc import Iterator, Sequence

from catseye.app.cell.arm import ArmDescription, Body
from catseye.app.cell.scara.sections import ScaraSections

_LONGEST_REACH_MM = 2000.0
_SAME_LINK_MM = 5.0
_LARGEST_TAKE_UP_DEG = 10.0
_SAME_COLUMN_MM = 1.0
_LONGEST_RUN_DAYS = 2.0


def implausible_sections(
    sections: ScaraSections, description: ArmDescription, own: Sequence[Body]
) -> list[str]:
    """Return what is hardly meant.

    Args:
        sections: of the cell file; nothing is missing there.
    """
    return [*_arm(sections, description, own), *_nodes(sections), *_places(sections)]


def _arm(sections: ScaraSections, description: ArmDescription, own: Sequence[Body]) -> Iterator[str]:
    optics, (link1_mm, link2_mm) = sections.optics, sections.robot.links_mm
    links = {"link1_mm": (link1_mm, "J2"), "link2_mm": (link2_mm, "J3")}
    nominal = {joint.name: joint.a_mm for joint in description.joint}
    for key, (length_mm, joint) in links.items():
        if abs(length_mm - nominal[joint]) > _SAME_LINK_MM:
            yield f"robot.{key} = {length_mm:g}: the {description.name} has {nominal[joint]:g} mm"
    reach_mm = link1_mm + link2_mm
    if reach_mm > _LONGEST_REACH_MM:
        yield (
            f"robot.link1_mm + robot.link2_mm = {reach_mm:g}: a reach of {reach_mm / 1000.0:g} m is no SCARA's; "
            "are both in mm?"
        )
    columns = [body.radius_mm for body in (*own, *description.body) if body.name == "base column"]
    if columns and abs(columns[0] - optics.column_radius_mm) > _SAME_COLUMN_MM:
        yield (
            f"optics.column_radius_mm = {optics.column_radius_mm:g} and the body base column has "
            f"{columns[0]:g} mm: they are the same column, seen by the beam and by the arm"
        )


def _nodes(sections: ScaraSections) -> Iterator[str]:
    timing = sections.measurement
    points = 4 * len(timing.theta1_deg) * len(timing.theta2_deg) * len(sections.reflectors)
    days = points * (timing.settle_time_s + timing.dwell_time_s) / 86_400.0
    if days > _LONGEST_RUN_DAYS:
        yield f"[measurement] waits for {days:.1f} days at {points} points: fewer nodes, or shorter times?"
    if timing.take_up_deg > _LARGEST_TAKE_UP_DEG:
        yield f"measurement.take_up_deg = {timing.take_up_deg:g}: usual are 0.5 … 2 deg"


def _places(sections: ScaraSections) -> Iterator[str]:
    optics, reach_mm = sections.optics, sum(sections.robot.links_mm)
    for reflector in sections.reflectors:
        away_mm = math.hypot(reflector.x_mm, reflector.y_mm)
        if away_mm > reach_mm + optics.beam_max_mm:
            yield (
                f"reflector {reflector.name} is {away_mm / 1000.0:.1f} m from the J1 axis: no pose brings it within "
                f"optics.beam_max_mm = {optics.beam_max_mm:g}"
            )
        elif away_mm < optics.column_radius_mm:
            yield f"reflector {reflector.name} stands inside the base column"
