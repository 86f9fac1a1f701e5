"""Targets at poses that identify an arm best, measured by a tracker or an optical CMM (six-axis paper, section 5)."""

from collections.abc import Sequence
from typing import Annotated, Final, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field

from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.needs import Needs
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.serial_arm.before import (
    CALIBRATE,
    CHECKED,
    COMPENSATE,
    DOSSIER,
    MEASURING,
    NESTS,
    POSE_TEXTS,
    REPORT,
    TARGETS,
    TRACKER,
    WARM,
)
from catseye.procedures.serial_arm.bench import SerialBench
from catseye.procedures.serial_arm.explained import TRACKER_CALIBRATION
from catseye.procedures.serial_arm.pose_params import (
    POSE_ROWS,
    GivenRow,
    PoseParams,
    finder_of,
    given_poses,
    measured_of,
    most_targets,
    name_of,
    named_targets,
    pose_plan,
)
from catseye.procedures.serial_arm.pose_plan import PoseFinder, PosePlan
from catseye.procedures.serial_arm.pose_run import PoseRun
from catseye.procedures.serial_arm.questions import TURN
from catseye.procedures.serial_arm.records import MeasuredNest, MeasuredTarget

Floats = NDArray[np.float64]

_ROUNDS: Final = 20
"""Choices that are made anew since a chosen pose cannot be reached."""


class CalibrationParams(PoseParams):
    """What may be chosen for the measurement of a calibration."""

    count: int = Field(38, ge=3, le=2000, title="Number of poses", description="number of poses to choose")
    candidates: int = Field(
        5000, ge=20, le=100_000, title="Candidates", description="number of random poses to choose from"
    )
    model: Literal["frames", "geometric", "geometric+compliance", "maps"] = Field(
        "geometric+compliance",
        title="Model to identify",
        description="model whose parameters the poses have to identify",
    )
    poses: Annotated[Sequence[GivenRow], POSE_ROWS] = Field(
        [],
        title="File of poses",
        description="CSV of catseye select-poses, used instead of choosing poses",
        json_schema_extra={"file": "CSV"},
    )


class TrackerCalibration(Procedure):
    """Measures targets at chosen poses, each approached from below."""

    name = "tracker-calibration"
    title = "Calibration of a serial arm"
    explanation = TRACKER_CALIBRATION
    needs = Needs(
        SerialBench, TRACKER, tracker=("points", "poses"), equipment=(TARGETS, NESTS), after=(WARM, CHECKED)
    )
    stage = MEASURING
    analyses = (CALIBRATE, COMPENSATE, REPORT, DOSSIER)
    records = (MeasuredTarget, MeasuredNest)
    event_texts = POSE_TEXTS
    questions = (TURN,)
    params_type = CalibrationParams

    def plan(self, bench: SerialBench, params: CalibrationParams) -> PosePlan:
        """Choose the poses, or take those that are given.

        Raises:
            PlanLimitError: a given pose lies outside the limits.
            PlanError: no or too few poses can be measured; the text says why.
        """
        finder = finder_of(bench, params)
        if params.poses:
            named = given_poses(bench, params.poses)
            finder.require(named, named_targets(params, params.poses))
        else:
            chosen = chosen_poses(bench, params, finder)
            named = [(name_of(number), pose) for number, pose in enumerate(chosen, 1)]
        return pose_plan(bench, params, named, params.poses)

    async def run(self, ctx: Context, plan: PosePlan) -> None:
        """Measure; see `PoseRun`."""
        await PoseRun(ctx, plan).run()


def chosen_poses(bench: SerialBench, params: CalibrationParams, finder: PoseFinder) -> list[Pose]:
    """Return the poses of random ones that identify the arm best and can be reached.

    Raises:
        PlanError: too few poses can be measured or reached, or they are too few for the model.
    """
    # The solver takes its time to import: whoever lists procedures does without.
    from catseye.calibration.core.errors import CalibrationError
    from catseye.calibration.serial_arm.arm import SerialArm, Target
    from catseye.calibration.serial_arm.design.exchange import select
    from catseye.calibration.serial_arm.design.pose_rows import pose_rows

    targets = tuple(Target(one.name, one.place_mm) for one in bench.chosen(params.targets))
    arm = SerialArm(bench.workspace.chain, bench.loads, targets)
    poses = finder.drawn(params.candidates, params.seed)
    reachable = np.ones(len(poses), dtype=np.bool_)
    try:
        frames = measured_of(bench, params) == "poses"
        shown = pose_rows(
            arm,
            poses,
            finder.all_seen(poses, most_targets(params, params.poses)),
            params.model,
            frames=frames,
        )
        for _ in range(_ROUNDS):
            left = np.flatnonzero(reachable)
            chosen = left[
                select(shown.rows[left], params.count, starts=1, seed=params.seed, known=shown.known).chosen
            ]
            named = [tuple(poses[k].tolist()) for k in chosen]
            reached = np.array(finder.reached(named))
            if reached.all():
                return named
            reachable[chosen[~reached]] = False
    except CalibrationError as error:
        raise PlanError(str(error)) from error
    raise PlanError(
        f"after {_ROUNDS} choices some poses still cannot be reached from the rest pose: choose another one "
        "(rest_deg), or correct [[body]] and [workspace] of the cell file"
    )
