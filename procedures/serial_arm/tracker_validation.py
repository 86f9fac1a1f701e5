"""Targets at random poses, which show what a calibration is worth (six-axis paper, section 6.2: 1000 of them)."""

from collections.abc import Sequence
from itertools import compress
from typing import Annotated

from pydantic import Field

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.serial_arm.before import (
    NESTS,
    POSE_TEXTS,
    TARGETS,
    TRACKER,
    VALIDATE,
    VALIDATING,
    WARM,
)
from catseye.procedures.serial_arm.bench import SerialBench
from catseye.procedures.serial_arm.explained import TRACKER_VALIDATION
from catseye.procedures.serial_arm.pose_params import (
    POSE_ROWS,
    GivenRow,
    PoseParams,
    finder_of,
    given_poses,
    name_of,
    named_targets,
    pose_plan,
)
from catseye.procedures.serial_arm.pose_plan import PoseFinder, PosePlan
from catseye.procedures.serial_arm.pose_run import PoseRun
from catseye.procedures.serial_arm.questions import TURN
from catseye.procedures.serial_arm.records import MeasuredNest, MeasuredTarget


class ValidationParams(PoseParams):
    """What may be chosen for a validation."""

    count: int = Field(1000, ge=1, le=20_000, title="Number of poses", description="number of random poses")
    nests_every: int = Field(
        100,
        ge=0,
        le=20_000,
        title="Poses between nests",
        description="number of poses after which the fixed nests are measured again; 0: never",
    )
    poses: Annotated[Sequence[GivenRow], POSE_ROWS] = Field(
        [],
        title="File of poses",
        description="CSV of poses, used instead of random ones",
        json_schema_extra={"file": "CSV"},
    )


class TrackerValidation(Procedure):
    """Measures targets at poses that are random within limits and sight."""

    name = "tracker-validation"
    title = "Validation of a serial arm"
    explanation = TRACKER_VALIDATION
    needs = Needs(
        SerialBench, TRACKER, tracker=("points", "poses"), equipment=(TARGETS, NESTS), after=(WARM,)
    )
    stage = VALIDATING
    analyses = (VALIDATE,)
    records = (MeasuredTarget, MeasuredNest)
    event_texts = POSE_TEXTS
    questions = (TURN,)
    params_type = ValidationParams

    def plan(self, bench: SerialBench, params: ValidationParams) -> PosePlan:
        """Draw the poses, or take those that are given.

        Raises:
            PlanLimitError: a given pose lies outside the limits.
            PlanError: no or too few poses can be measured; the text says why.
        """
        finder = finder_of(bench, params)
        if params.poses:
            named = given_poses(bench, params.poses)
            finder.require(named, named_targets(params, params.poses))
        else:
            named = reachable(finder, params.count, params.seed)
        return pose_plan(bench, params, named, params.poses)

    async def run(self, ctx: Context, plan: PosePlan) -> None:
        """Measure; see `PoseRun`."""
        await PoseRun(ctx, plan).run()


def reachable(finder: PoseFinder, count: int, seed: int) -> list[tuple[str, Pose]]:
    """Return random poses that can be measured and reached, with names.

    Raises:
        PlanError: hardly any pose can.
    """
    found: list[Pose] = []
    block = 0
    while len(found) < count:
        # A block that brings nothing ends in the error of `drawn`, which counts what it refuses.
        drawn = finder.drawn(count - len(found) + 20, seed + 1_000_003 * block)
        poses = [tuple(pose) for pose in drawn.tolist()]
        found += compress(poses, finder.reached(poses))
        block += 1
        finder.require_some(found, block)
    return [(name_of(number), pose) for number, pose in enumerate(found[:count], 1)]
