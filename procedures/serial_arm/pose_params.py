"""What may be chosen for measuring targets at poses, and the plan that follows from it."""

from collections import Counter
from collections.abc import Sequence
from itertools import groupby
from typing import Annotated, Final, TypeAlias

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field

from catseye.drivers.roles.pose import Pose, pose_of
from catseye.procedures.kit.columns import ColumnRule, TableRule
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.system import System
from catseye.procedures.serial_arm.axis_turns import plan_frames
from catseye.procedures.serial_arm.bench import SerialBench
from catseye.procedures.serial_arm.pose_plan import Measured, PoseFinder, PosePlan

Floats = NDArray[np.float64]

Degrees = Annotated[float, Field(ge=-720.0, le=720.0)]

JointRow = Annotated[list[float], Field(min_length=1)]
"""A value for each axis, deg or mm."""

POSE_ROWS: Final = TableRule(
    "poses",
    "the joints of a pose",
    (tuple(ColumnRule(f"q{number}_deg", unit="deg") for number in range(1, 7)),),
    source="the CSV that catseye select-poses writes, of an arm with six axes",
    named=True,
)


class GivenPose(BaseModel):
    """A pose of a file.

    Attributes:
        pose: its name.
        joints: a value for each axis, deg or mm.
        rows: that the file has of it, one a target.
        targets: that these rows name; empty where they name none.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    pose: str
    joints: JointRow
    rows: int = Field(1, ge=1)
    targets: list[str] = []


GivenRow: TypeAlias = JointRow | GivenPose
"""A pose by its name, or a row of joints without one."""

_TRIED_FOR_FRAMES: Final = 60


class PoseParams(BaseModel):
    """What may be chosen for measuring targets at poses."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    targets: list[str] = Field([], title="Targets", description="names of the tool's targets; empty: all")
    targets_per_pose: int | None = Field(
        None,
        ge=1,
        le=20,
        title="Targets per pose",
        description="targets measured at each pose, those that face the instrument best; by default those in the "
        "file of poses, else 1",
    )
    measured: Measured | None = Field(
        None,
        title="What is measured",
        description="points (tracker) or poses (optical CMM); by default what the driver can measure",
    )
    approach_deg: float = Field(
        5.0,
        ge=0.0,
        le=20.0,
        title="Approach from, deg",
        description="every axis approaches its position from this much below, deg",
    )
    rest_deg: list[Degrees] = Field(
        [],
        title="Rest pose, deg",
        description="safe pose on the way between poses that have no direct path, one value per axis; empty: zeros",
    )
    settle_s: float = Field(
        0.5, ge=0.0, le=60.0, title="Settling, s", description="wait at standstill before a measurement, s"
    )
    dwell_s: float = Field(
        4.0, ge=0.1, le=120.0, title="Averaging, s", description="time that the instrument averages over, s"
    )
    nests_every: int = Field(
        10,
        ge=0,
        le=10_000,
        title="Poses between nests",
        description="number of poses after which the fixed nests are measured again; 0: never",
    )
    drift_limit_mm: float = Field(
        0.05,
        gt=0.0,
        le=10.0,
        title="Warn of drift, mm",
        description="drift of a nest beyond which a warning is given, mm",
    )
    frames: bool = Field(
        False, title="Find base and tool", description="first turn single axes to find base and tool"
    )
    marks_of_tool: int = Field(
        9,
        ge=0,
        le=1000,
        title="Marks of the tool",
        description="marks of the tool that an optical CMM has to see, if it reports their number",
    )
    marks_of_base: int = Field(
        12,
        ge=0,
        le=1000,
        title="Marks of the base",
        description="marks of the base that an optical CMM has to see, if it reports their number",
    )
    seed: int = Field(0, ge=0, le=2**31, title="Random seed", description="seed of all random choices")


def rest_of(bench: SerialBench, given: list[float]) -> Pose:
    """Return the pose from which others are reached.

    Raises:
        PlanError: a value is missing, or there is one too many.
    """
    if not given:
        return System(bench).rest
    try:
        return pose_of(bench.arm.axes, given)
    except ValueError as error:
        raise PlanError(f"rest_deg: {error}; give one value for each axis") from error


def finder_of(bench: SerialBench, params: PoseParams) -> PoseFinder:
    """Return what finds poses with these parameters.

    Raises:
        PlanError: the tool has no such target, or fewer than are to be measured at a pose.
    """
    targets = bench.chosen(params.targets)
    if params.targets_per_pose is not None and params.targets_per_pose > len(targets):
        names = ", ".join(one.name for one in targets)
        raise PlanError(
            f"targets_per_pose = {params.targets_per_pose}, and there {'is' if len(targets) == 1 else 'are'} {names} "
            f"only: ask for at most {len(targets)}, name more in targets, or add [[target]] to the tool's file"
        )
    return PoseFinder(
        bench,
        targets,
        measured_of(bench, params),
        params.approach_deg,
        rest_of(bench, params.rest_deg),
    )


def measured_of(bench: SerialBench, params: PoseParams) -> Measured:
    """Return what is measured: as asked for, else what the instrument can do.

    Raises:
        PlanError: the instrument cannot do what is asked for.
    """
    able = bench.instrument.abilities
    wanted: Measured = params.measured or ("points" if able.points else "poses")
    if not (able.points if wanted == "points" else able.poses):
        raise PlanError(
            f"measured = {wanted}: the tracker's driver does not measure that: choose the other, or another driver"
        )
    return wanted


def pose_plan(
    bench: SerialBench, params: PoseParams, named: list[tuple[str, Pose]], given: Sequence[GivenRow]
) -> PosePlan:
    """Return the plan of poses that can all be measured.

    Args:
        given: of a CSV; none where the poses were chosen.

    Raises:
        PlanError: frames are asked for and cannot be found by turning axes.
    """
    finder, measured = finder_of(bench, params), measured_of(bench, params)
    rest = rest_of(bench, params.rest_deg)
    frames = None
    if params.frames:
        if measured == "poses":
            raise PlanError("frames = true takes points, and the instrument measures poses: leave it out")
        tried = finder.drawn(_TRIED_FOR_FRAMES, params.seed + 1)
        frames = plan_frames(bench, tried, bench.chosen(params.targets), rest, params.approach_deg)
    return PosePlan(
        bench=bench,
        measured=measured,
        rest=rest,
        poses=finder.linked(named, most_targets(params, given), named_targets(params, given)),
        frames=frames,
        settle_s=params.settle_s,
        dwell_s=params.dwell_s,
        nests_every=params.nests_every,
        drift_limit_mm=params.drift_limit_mm,
        marks=params.marks_of_tool,
        base_marks=params.marks_of_base,
    )


def most_targets(params: PoseParams, given: Sequence[GivenRow]) -> int:
    """Return how many targets are measured at a pose: as asked for, else as many as a given pose has rows."""
    return params.targets_per_pose or max((one.rows for one in _by_name(given)), default=1)


def named_targets(params: PoseParams, given: Sequence[GivenRow]) -> dict[str, tuple[str, ...]]:
    """Return the targets to measure at each pose of a file that names them, unless their number is asked for."""
    if params.targets_per_pose is not None:
        return {}
    return {one.pose: tuple(one.targets) for one in _by_name(given) if one.targets}


def given_poses(bench: SerialBench, given: Sequence[GivenRow]) -> list[tuple[str, Pose]]:
    """Return poses that were given, with names.

    Raises:
        PlanError: a pose has another number of values than the arm has axes, or two have the same name.
    """
    poses = _by_name(given)
    twice = [name for name, count in Counter(one.pose for one in poses).items() if count > 1]
    if twice:
        raise PlanError(f"poses: {twice[0]} is given twice: give each pose its own name")
    try:
        return [(one.pose, pose_of(bench.arm.axes, one.joints)) for one in poses]
    except ValueError as error:
        raise PlanError(f"poses: {error}; give one value for each axis") from error


def _by_name(given: Sequence[GivenRow]) -> list[GivenPose]:
    """Return poses with names; rows without one that follow each other and are the same, one a target, are one."""
    found: list[GivenPose] = []
    for row, same in groupby(given):
        if isinstance(row, GivenPose):
            found += [row for _ in same]
        else:
            found.append(GivenPose(pose=name_of(len(found) + 1), joints=row, rows=len(list(same))))
    return found


def name_of(number: int) -> str:
    """Return the name of a pose by its number, from 1."""
    return f"P{number:04d}"
