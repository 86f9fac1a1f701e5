"""What sightings give: places and θ40, how well the beam will be aimed, what does not fit, where to look next."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.planar import forward
from catseye.calibration.scara.reflector_search import SearchResult, Sightings, locate_reflectors
from catseye.calibration.scara.search_outlier import Outlier, find_outlier
from catseye.procedures.scara.bench import Reflector
from catseye.procedures.scara.search.search_plan import SearchPlan, SearchPose
from catseye.procedures.scara.search.sighting import Sighting

FEWEST_SIGHTINGS = 3

COVERAGE = 2.0
"""Twice the standard uncertainty of the aim has to leave room for the plan's own miss."""

_OUTLIER_SHARE = 0.5
"""A sighting that is off by less than this share of the acceptance harms nobody."""


@dataclass(frozen=True)
class LeftOut:
    """A sighting that contradicts the others.

    Attributes:
        pose: from where it was made.
        text: what is wrong with it.
    """

    pose: SearchPose
    text: str


@dataclass(frozen=True)
class Assessment:
    """What the sightings so far give.

    Attributes:
        kept: sightings that were used.
        left_out: those that were not.
        found: the solution; None where it is not determined yet.
        trouble: why not; empty otherwise.
        aim_mm: worst standard uncertainty of the beam's place at each reflector; empty without a solution.
        room_mm: what twice the uncertainty may be.
    """

    kept: tuple[Sighting, ...]
    left_out: tuple[LeftOut, ...]
    found: SearchResult | None
    trouble: str
    aim_mm: tuple[float, ...] = ()
    room_mm: float = 0.0

    def count(self, reflector: Reflector) -> int:
        """Return how many sightings of a reflector were used."""
        return sum(seen.pose.reflector == reflector for seen in self.kept)

    def holds(self, index: int) -> bool:
        """Return whether the aim at a reflector is good enough for the whole plan."""
        return bool(self.aim_mm) and COVERAGE * self.aim_mm[index] <= self.room_mm


def assess(plan: SearchPlan, sightings: Sequence[Sighting]) -> Assessment:
    """Solve Eq. 2 for all reflectors together; sightings that contradict the others are left out."""
    kept = list(sightings)
    left_out: list[LeftOut] = []
    optics = plan.bench.optics
    room_mm = optics.acceptance_mm - optics.max_miss_mm
    while True:
        try:
            found = _solved(plan, kept)
        except CalibrationError as error:
            return Assessment(tuple(kept), tuple(left_out), None, str(error), room_mm=room_mm)
        outlier = find_outlier(
            sightings_table(plan.reflectors, kept),
            found,
            plan.bench.link1_mm,
            plan.bench.link2_mm,
            _OUTLIER_SHARE * optics.acceptance_mm,
        )
        if outlier is None:
            break
        gone = kept.pop(outlier.row)
        left_out.append(_left_out(gone, outlier))
    aim = tuple(_worst_aim_mm(plan, found, index) for index in range(len(plan.reflectors)))
    return Assessment(tuple(kept), tuple(left_out), found, "", aim, room_mm)


def weakest(
    plan: SearchPlan, now: Assessment, spare: Sequence[SearchPose], looked: Mapping[str, int]
) -> SearchPose | None:
    """Return the pose to look from next; None when the aim holds everywhere or no pose would help.

    Of the reflectors whose aim does not hold the worst one is looked at, from where its worst aim gains most; without
    a solution the one with the fewest sightings, from the pose farthest from all others. A reflector that returned
    the beam from fewer than half of the poses is not looked for again: more poses are not what it lacks.

    Args:
        spare: poses not yet looked from, each next one far from those before.
        looked: how often each reflector was looked for, by name.
    """
    doubtful = [
        index
        for index, reflector in enumerate(plan.reflectors)
        if 2 * now.count(reflector) >= looked[reflector.name]
        and (not now.holds(index) or now.count(reflector) < FEWEST_SIGHTINGS)
    ]

    def urgency(index: int) -> tuple[float, float]:
        few = float(min(now.count(plan.reflectors[index]), FEWEST_SIGHTINGS))
        return (few, -now.aim_mm[index] if now.aim_mm else 0.0)

    for index in sorted(doubtful, key=urgency):
        poses = [pose for pose in spare if pose.reflector == plan.reflectors[index]]
        if poses:
            found = now.found
            return poses[0] if found is None else min(poses, key=partial(_aim_after, plan, found, index))
    return None


def _aim_after(plan: SearchPlan, found: SearchResult, index: int, pose: SearchPose) -> float:
    """Return the worst aim at a reflector after one more look at it from a pose, mm."""
    bench = plan.bench
    one, two = np.deg2rad([pose.theta1_deg, pose.theta2_deg])
    xy_mm = forward(np.asarray(one), np.asarray(two), bench.link1_mm, bench.link2_mm)
    return _worst_aim_mm(plan, found.with_sighting(xy_mm, index), index)


def _left_out(gone: Sighting, outlier: Outlier) -> LeftOut:
    pose = gone.pose
    text = (
        f"reflector {pose.reflector.name} as seen from θ1 = {pose.theta1_deg:g}°, θ2 = {pose.theta2_deg:g}° is "
        f"{math.degrees(outlier.off_rad):+.2f}° ({outlier.off_mm:+.1f} mm) beside where all other sightings have it: "
        "another reflector or a reflection was caught; the sighting is left out. Cover what else may reflect"
    )
    return LeftOut(pose, text)


def _solved(plan: SearchPlan, sightings: Sequence[Sighting]) -> SearchResult:
    bench = plan.bench
    rough = np.array([reflector.xy_mm for reflector in plan.reflectors])
    start = math.radians(plan.bench.optics.theta40_deg)
    return locate_reflectors(
        sightings_table(plan.reflectors, sightings), bench.link1_mm, bench.link2_mm, rough, start
    )


def sightings_table(reflectors: Sequence[Reflector], sightings: Sequence[Sighting]) -> Sightings:
    """Return sightings of reflectors as columns."""
    rows = np.deg2rad([[s.pose.theta1_deg, s.pose.theta2_deg, s.j4_deg] for s in sightings]).reshape(-1, 3)
    index = np.array([reflectors.index(s.pose.reflector) for s in sightings], dtype=np.int64)
    return Sightings(rows[:, 0], rows[:, 1], rows[:, 2], index)


def _worst_aim_mm(plan: SearchPlan, found: SearchResult, index: int) -> float:
    """Return the largest standard uncertainty of the beam's place over the commands that see the reflector."""
    positions: Floats = plan.command_positions_mm[index]
    return float(found.aim_uncertainty_mm(positions, index).max())
