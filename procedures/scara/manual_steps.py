"""Where a step by hand leads: pure geometry of the nominal arm."""

import math

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.planar import forward, wrap_rad
from catseye.calibration.scara.pointing import aim as aimed_j4_rad
from catseye.calibration.scara.pointing import beam_direction, nearest_branch
from catseye.drivers.roles.pose import Pose, with_axis
from catseye.procedures.kit.errors import ManualStepError
from catseye.procedures.scara.bench import Reflector, ScaraBench

_AHEAD_RAD = math.radians(30.0)
"""A beam that points further away than this from a reflector is not steered by millimetres at it."""

PLACES = {"j1": 0, "j2": 1, "j4": 3}
"""What is stepped by hand, and where it stands in a pose."""


def step_target(bench: ScaraBench, here: Pose, joint: str, by: float, aim: str | None = None) -> Pose:
    """Return the joints at the end of a step.

    Angles count counter-clockwise seen from above, and so does the beam: a positive step moves it to the left as one
    looks along it. With an aim, J4 keeps the beam as far beside that reflector's place as it is now, so that a beam
    which has been found is kept although the place is only rough.

    Args:
        bench: nominal arm, direction of the beam, places of the reflectors.
        joint: what moves; "beam" turns J4.
        by: deg; for the beam mm sideways at the reflector.
        aim: the reflector; means nothing where J4 is stepped by an angle.

    Raises:
        ManualStepError: there is no such reflector, the beam's step has none, or the beam points elsewhere.
    """
    if joint == "beam":
        return _beside(bench, here, by, aim)
    if joint not in PLACES:
        raise ManualStepError(f"there is no axis {joint!r} to move; there are {', '.join([*PLACES, 'beam'])}")
    target = with_axis(here, PLACES[joint], here[PLACES[joint]] + by)
    if joint != "j4" and aim is not None:
        target = with_axis(target, 3, _following_j4_deg(bench, here, (target[0], target[1]), aim))
    return target


def _beside(bench: ScaraBench, here: Pose, by_mm: float, aim: str | None) -> Pose:
    if aim is None:
        raise ManualStepError(
            f"a step of the beam is measured at a reflector: say at which; there are {_names(bench)}"
        )
    length_mm, off_rad = _sight(bench, here, _reflector(bench, aim))
    moved_rad = math.atan(math.tan(off_rad) + by_mm / length_mm)
    return here[0], here[1], here[2], here[3] + math.degrees(moved_rad - off_rad)


def _following_j4_deg(bench: ScaraBench, here: Pose, arm_deg: tuple[float, float], aim: str) -> float:
    reflector = _reflector(bench, aim)
    length_mm, off_rad = _sight(bench, here, reflector)
    beside_mm = length_mm * math.tan(off_rad)
    one, two = np.deg2rad(arm_deg)
    xy_mm = forward(one, two, bench.link1_mm, bench.link2_mm)
    towards_rad = beam_direction(xy_mm, reflector.xy_mm)
    world_rad = towards_rad + math.atan(beside_mm / _length_mm(bench, xy_mm, reflector))
    j4_rad = aimed_j4_rad(one, two, world_rad, math.radians(bench.optics.theta40_deg))
    return math.degrees(nearest_branch(j4_rad, math.radians(here[3])))


def _sight(bench: ScaraBench, here: Pose, reflector: Reflector) -> tuple[float, float]:
    """Return the distance to a reflector, mm, and the angle from it to the beam, rad, to the left positive.

    Raises:
        ManualStepError: the beam points elsewhere.
    """
    one, two, four = np.deg2rad((here[0], here[1], here[3]))
    xy_mm = forward(one, two, bench.link1_mm, bench.link2_mm)
    world_rad = one + two + four + math.radians(bench.optics.theta40_deg)
    off_rad = float(wrap_rad(world_rad - beam_direction(xy_mm, reflector.xy_mm)))
    if abs(off_rad) > _AHEAD_RAD:
        raise ManualStepError(
            f"the beam points {math.degrees(off_rad):.1f}° past {reflector.name}: turn J4 by "
            f"{-math.degrees(off_rad):.1f} deg first"
        )
    return _length_mm(bench, xy_mm, reflector), off_rad


def _length_mm(bench: ScaraBench, xy_mm: Floats, to: Reflector) -> float:
    length_mm = float(np.hypot(*(to.xy_mm - xy_mm)))
    shortest_mm = bench.optics.beam_min_mm
    if length_mm < shortest_mm:
        raise ManualStepError(
            f"the J4 axis is {length_mm:.0f} mm from {to.name}, and a beam is {shortest_mm:g} mm long at least: step "
            "without aim"
        )
    return length_mm


def _reflector(bench: ScaraBench, name: str) -> Reflector:
    for reflector in bench.reflectors:
        if reflector.name == name:
            return reflector
    raise ManualStepError(f"there is no reflector {name!r}; there are {_names(bench)}")


def _names(bench: ScaraBench) -> str:
    return ", ".join(reflector.name for reflector in bench.reflectors)
