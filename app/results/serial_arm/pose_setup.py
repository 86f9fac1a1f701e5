"""What a choice of poses begins with: arm, targets, instrument and rules, of descriptions or of a whole cell."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import cast

import numpy as np

from catseye.app.cell.arm import ArmDescription
from catseye.app.cell.bench import bench_for
from catseye.app.cell.bodies import capsules_of
from catseye.app.cell.model import Cell
from catseye.app.cell.serial_arm import point_of
from catseye.app.cell.tool import ToolDescription
from catseye.app.errors import UsageError
from catseye.app.results.serial_arm.nominal_arm import serial_arm_of
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.bodies import Point, Scene
from catseye.calibration.kinematics.joint_ranges import ranges_of
from catseye.calibration.serial_arm.arm import SerialArm, Target
from catseye.calibration.serial_arm.design.candidates import Rules, Sight
from catseye.calibration.serial_arm.design.observability import Index
from catseye.calibration.serial_arm.identification import ModelName
from catseye.calibration.serial_arm.sight import View
from catseye.procedures.kit.motion.clear_way import scene_of
from catseye.procedures.serial_arm.bench import Instrument, SerialBench
from catseye.procedures.serial_arm.pose_params import PoseParams, measured_of
from catseye.procedures.serial_arm.pose_plan import Measured
from catseye.procedures.serial_arm.sight import view_of
from catseye.procedures.serial_arm.tracker_calibration import TrackerCalibration


@dataclass(frozen=True)
class Asked:
    """What is to be chosen.

    Attributes:
        count: of poses.
        candidates: that are drawn.
        index: of observability.
        model: whose parameters the poses are to show.
        starts: random choices to begin with.
        station_mm: the instrument in the frame of the arm's base; None: it sees the targets everywhere.
        cone_deg: largest angle between where a nest looks and the line of sight; None: what cells have by
            default, or this one says.
        face_deg: likewise of a plate with marks on both faces.
        targets: names of those that may be measured; all without names.
        measured: points of a tracker or whole frames of an optical CMM; None: what the cell's instrument can do.
        targets_per_pose: that are measured at one, as far as they are seen.
        limits: narrower ranges by joint, deg or mm.
        approach: by how much below each joint begins its last move.
        with_bodies: the bodies of the arm's description count.
    """

    count: int
    candidates: int = 5000
    index: Index = "O1"
    model: ModelName = "geometric+compliance"
    starts: int = 3
    seed: int = 1
    station_mm: Point | None = None
    cone_deg: float | None = None
    face_deg: float | None = None
    targets: tuple[str, ...] = ()
    measured: Measured | None = None
    targets_per_pose: int = 1
    limits: dict[str, tuple[float, float]] = field(default_factory=dict)
    approach: float = 5.0
    with_bodies: bool = True


@dataclass(frozen=True)
class PoseSetup:
    """What poses are chosen for.

    Attributes:
        arm: nominal, with its targets.
        rules: that a pose has to keep.
        units: of the joints.
        frames: the instrument measures the orientation of targets too.
    """

    arm: SerialArm
    rules: Rules
    units: tuple[str, ...]
    frames: bool


def setup_of(description: ArmDescription, tool: ToolDescription, asked: Asked) -> PoseSetup:
    """Return what poses are chosen for with an arm and a tool, and nothing around them.

    Raises:
        UsageError: the tool has no target, or lacks one that is asked for, or a limit names no joint.
    """
    if not tool.target:
        raise UsageError(f"the tool {tool.name} has no [[target]]: state what the instrument measures")
    tool = _with(tool, asked.targets)
    arm, frames = serial_arm_of(description, tool), asked.measured == "poses"
    bodies = capsules_of(description.body, arm.chain) if asked.with_bodies else ()
    normals = tuple(None if one.normal is None else point_of(one.normal) for one in tool.target)
    sight = None
    if asked.station_mm is not None:
        stated_deg = asked.face_deg if frames else asked.cone_deg
        usual_deg = Instrument.face_deg if frames else Instrument.cone_deg
        within_deg = usual_deg if stated_deg is None else stated_deg
        sight = Sight(View(asked.station_mm, within_deg, frames, bodies), normals)
    scene = Scene(arm.chain, bodies) if bodies else None
    units = tuple(joint.unit for joint in description.joint)
    return PoseSetup(arm, _rules(arm, asked, ranges_of(arm.chain), scene, sight), units, frames)


def setup_of_cell(cell: Cell, asked: Asked) -> PoseSetup:
    """Return what poses are chosen for in a cell: its arm, limits, instrument, bodies and boxes.

    Raises:
        ConfigError: the cell lacks what a calibration needs.
        PlanError: the tool has no target, or lacks one that is asked for, or the instrument cannot measure it.
        UsageError: a limit names no joint.
    """
    bench = cast("SerialBench", bench_for(cell, TrackerCalibration.needs, "select-poses"))
    targets = bench.chosen(list(asked.targets))
    frames = measured_of(bench, PoseParams(measured=asked.measured)) == "poses"
    arm = SerialArm(
        bench.workspace.chain, bench.loads, tuple(Target(one.name, one.place_mm) for one in targets)
    )
    sight = Sight(view_of(bench, as_frame=frames), tuple(one.normal for one in targets))
    low, high = np.array([axis.range for axis in bench.arm.axes]).T
    # The approach, too, has to stay within the limits of the cell.
    ends = (low + asked.approach, high)
    rules = _rules(arm, asked, ends, scene_of(bench), sight, bench.workspace.clearance_mm)
    return PoseSetup(arm, rules, tuple(axis.unit for axis in bench.arm.axes), frames)


def _with(tool: ToolDescription, names: Sequence[str]) -> ToolDescription:
    """Return a tool with some of its targets; all without names."""
    known = {one.name: one for one in tool.target}
    if lacking := [name for name in names if name not in known]:
        raise UsageError(f"--target {lacking[0]}: the tool has {', '.join(known)}")
    return tool.model_copy(update={"target": [known[name] for name in names] or tool.target})


def _rules(
    arm: SerialArm,
    asked: Asked,
    ranges: Sequence[Floats],
    scene: Scene | None,
    sight: Sight | None,
    gap_mm: float = Rules.gap_mm,
) -> Rules:
    names = list(arm.joint_names)
    low, high = (ends.copy() for ends in ranges)
    for name, (least, most) in asked.limits.items():
        if name not in names:
            raise UsageError(f"--limit {name}: the arm has the joints {', '.join(names)}")
        joint = names.index(name)
        low[joint], high[joint] = max(low[joint], least), min(high[joint], most)
    return Rules(scene, sight, asked.approach, gap_mm, low, high, asked.targets_per_pose)
