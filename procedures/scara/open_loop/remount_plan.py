"""Where the interferometer is turned on the flange of J4, between the halves of a measurement, and aligned anew."""

from dataclasses import dataclass, replace
from typing import Final

from catseye.drivers.roles.pose import Pose, with_axis
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.clear_way import way_refusal
from catseye.procedures.scara.alignment.beam_level import BeamLevel, BeamLevelParams, BeamLevelPlan
from catseye.procedures.scara.alignment.beam_to_j4 import BeamToJ4, BeamToJ4Params, BeamToJ4Plan
from catseye.procedures.scara.alignment.screws import ROUND_S
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.search.search_plan import SearchPose, plan_search

HALF_TURN_DEG: Final = 180.0

MOST_OFF_DEG: Final = 5.0
"""A mounting that is off by more is turned once more; in the turned half J4 is planned so far inside its limits."""

_ROUNDS: Final = 7
"""Measurements that levelling and alignment usually take together, and as long as one of them for the angle."""

_SIGHTS: Final = 4
"""Poses from which each reflector is looked at for the angle: the joints' deviations average out as in a search."""

_SIGHT_RANGE_DEG: Final = 2.0
"""How far J4 may turn there; other reflectors stand further aside."""

_J4: Final = 3


@dataclass(frozen=True)
class RemountPlan:
    """Where the arm stands meanwhile, and how the beam is aligned then.

    Attributes:
        level: how the beam is levelled; at the first of its poses the interferometer is turned.
        stage: how the beam is brought to the J4 axis.
        sights: from where the angle of the mounting is found in the end.
        former_j4_deg: J4 at which the beam of an interferometer that was not turned returns there; None where J4 does
            not get there.
    """

    level: BeamLevelPlan
    stage: BeamToJ4Plan
    sights: tuple[SearchPose, ...]
    former_j4_deg: float | None

    @property
    def pose(self) -> SearchPose:
        """Where the arm stands while the interferometer is turned: then its beam meets the reflector."""
        return self.level.poses[0]

    @property
    def duration_s(self) -> float:
        """Expected time of the alignment, s; that of the hands is theirs."""
        return _ROUNDS * ROUND_S


def turned_bench(bench: ScaraBench) -> ScaraBench:
    """Return the bench of the turned half, with room for a mounting that is a little off."""
    axes = list(bench.arm.axes)
    four = axes[_J4]
    axes[_J4] = replace(four, low=four.low + MOST_OFF_DEG, high=four.high - MOST_OFF_DEG)
    return replace(bench, arm=replace(bench.arm, axes=tuple(axes))).mounted(HALF_TURN_DEG)


def plan_remount(bench: ScaraBench, reflectors: tuple[str, ...]) -> RemountPlan:
    """Plan the turning and the alignment.

    Args:
        bench: as it is in the first half.
        reflectors: names of those that are measured; all when empty.

    Raises:
        PlanError: the beam cannot be aligned on any of them.
    """
    turned, failures = turned_bench(bench), []
    for name in reflectors or ("",):
        try:
            level = BeamLevel().plan(turned, BeamLevelParams(reflector=name))
            stage = BeamToJ4().plan(turned, BeamToJ4Params(reflector=name))
            one = (level.poses[0].reflector.name,)
            sights = _sights(turned, one if bench.optics.one_reflector else reflectors)
        except PlanError as error:
            failures.append(str(error))
        else:
            return RemountPlan(level, stage, sights, _former_deg(level.poses[0], bench))
    raise PlanError(
        f"j4_reversal levels and aligns the beam again once the interferometer is turned: {'; '.join(failures)}"
    )


def _sights(bench: ScaraBench, names: tuple[str, ...]) -> tuple[SearchPose, ...]:
    wanted = {reflector.name for reflector in bench.chosen(names)}
    poses = plan_search(bench, _SIGHTS, _SIGHT_RANGE_DEG).poses
    return tuple(pose for pose in poses if pose.reflector.name in wanted)


def _former_deg(pose: SearchPose, bench: ScaraBench) -> float | None:
    here: Pose = (pose.theta1_deg, pose.theta2_deg, bench.j3_mm, pose.j4_deg)
    for turn_deg in (HALF_TURN_DEG, -HALF_TURN_DEG):
        there = with_axis(here, _J4, pose.j4_deg + turn_deg)
        if bench.arm.axes[_J4].allows(there[_J4]) and way_refusal((here, there), bench) is None:
            return there[_J4]
    return None
