"""Plans of poses: seen, within limits, approached from below, clear; against geometry by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.app.engine.dry_run import DryRunContext
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.kinematics.bodies import Box
from catseye.calibration.serial_arm import sight
from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.kit.motion.clear_way import way_refusal
from catseye.procedures.kit.system import System
from catseye.procedures.serial_arm.axis_turns import turns_over
from catseye.procedures.serial_arm.bench import SerialBench, ToolTarget
from catseye.procedures.serial_arm.pose_params import GivenPose, PoseParams, finder_of
from catseye.procedures.serial_arm.sight import seen, sighted, view_of
from catseye.procedures.serial_arm.tracker_calibration import CalibrationParams, TrackerCalibration
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams
from tests.declared_questions import undeclared
from tests.unit.procedures.serial_arm.benches import CMM, SIX, STATION_MM
from tests.unit.procedures.six_axes import CHAIN, HEIGHT_MM, REACH_MM

FORWARD = np.zeros((1, 6))
"""Forearm level, flange looking along x: its z is the base's x."""


def off_normal_deg(bench: SerialBench, poses: Floats, target: ToolTarget) -> Floats:
    return sight.off_normal_deg(view_of(bench), CHAIN.flange(poses), sighted(target))


def in_line_of_sight(bench: SerialBench, poses: Floats, target: ToolTarget) -> Bools:
    return sight.in_line_of_sight(view_of(bench), CHAIN.frames(poses), sighted(target))


SMALL = ValidationParams(count=12, nests_every=5)


def test_a_target_looks_past_by_the_angle_of_its_sight() -> None:
    place = np.array([REACH_MM + 125.0, 0.0, HEIGHT_MM])
    sight = STATION_MM - place
    expected = math.degrees(math.acos(sight[0] / np.linalg.norm(sight)))
    assert off_normal_deg(SIX, FORWARD, SIX.target("N1")) == pytest.approx([expected])
    assert seen(SIX, FORWARD, SIX.target("N1")).tolist() == [expected <= 30.0]
    # Turned by 90° about the vertical axis it looks sideways.
    aside = FORWARD.copy()
    aside[0, 0] = -90.0
    assert off_normal_deg(SIX, aside, SIX.target("N1"))[0] > 60.0
    assert not seen(SIX, aside, SIX.target("N1"))[0]


def test_a_plate_is_seen_from_behind_as_a_frame() -> None:
    behind = FORWARD.copy()
    behind[0, 0] = 172.0
    plate = ToolTarget("plate", (0.0, 0.0, 100.0), (0.0, 0.0, 1.0))
    bench = replace(CMM, workspace=replace(CMM.workspace, bodies=()))
    assert not seen(bench, behind, plate)[0]
    assert seen(bench, behind, plate, as_frame=True)[0] == (
        180.0 - off_normal_deg(bench, behind, plate)[0] <= 15.0
    )


def test_the_forearm_hides_what_is_behind_it() -> None:
    away = FORWARD.copy()
    away[0, 0] = 172.6
    # The tracker, the arm's axis and the target lie in one plane then: forearm and wrist stand in between.
    assert not in_line_of_sight(SIX, away, SIX.target("N1"))[0]
    assert in_line_of_sight(SIX, FORWARD, SIX.target("N1"))[0]


def test_a_box_in_the_line_of_sight_hides_a_target() -> None:
    middle = 0.5 * (STATION_MM + np.array([REACH_MM + 125.0, 0.0, HEIGHT_MM]))
    low, high = (tuple((middle + by).tolist()) for by in (-30.0, 30.0))
    boxed = replace(SIX, workspace=replace(SIX.workspace, keep_out=(Box("cabinet", low, high),)))
    assert not in_line_of_sight(boxed, FORWARD, SIX.target("N1"))[0]


def test_random_poses_are_seen_and_come_from_below() -> None:
    plan = TrackerValidation().plan(SIX, SMALL)
    assert len(plan.poses) == 12
    for one in plan.poses:
        assert np.array(one.pose) - np.array(one.approach) == pytest.approx([5.0] * 6)
        for axis, value in zip(SIX.arm.axes, one.approach, strict=True):
            assert axis.low <= value
        (name,) = one.targets
        at = np.array([one.pose])
        flange = CHAIN.flange(at)[0]
        target = SIX.target(name)
        place = (flange @ [*target.place_mm, 1.0])[:3]
        looks = flange[:3, :3] @ np.array(target.normal)
        sight = STATION_MM - place
        assert looks @ sight / np.linalg.norm(sight) >= math.cos(math.radians(30.0)) - 1e-9


def test_the_seed_decides_the_poses() -> None:
    one, again = (TrackerValidation().plan(SIX, SMALL).poses for _ in range(2))
    other = TrackerValidation().plan(SIX, SMALL.model_copy(update={"seed": 1})).poses
    assert one == again
    assert one != other


def test_chosen_poses_identify_better_than_random_ones() -> None:
    from catseye.calibration.serial_arm.arm import SerialArm, Target
    from catseye.calibration.serial_arm.design.pose_rows import pose_rows

    params = CalibrationParams(count=14, candidates=400, model="geometric")
    chosen = TrackerCalibration().plan(SIX, params).poses
    random = TrackerValidation().plan(SIX, ValidationParams(count=14)).poses
    arm = SerialArm(CHAIN, (), tuple(Target(one.name, one.place_mm) for one in SIX.targets))
    names = [one.name for one in SIX.targets]

    def index(poses: object) -> float:
        joints = np.array([one.pose for one in poses])  # type: ignore[attr-defined]  # planned poses
        target = np.array([names.index(one.targets[0]) for one in poses])  # type: ignore[attr-defined]  # as above
        rows = pose_rows(arm, joints, target[:, None], "geometric").rows
        flat = rows.reshape(-1, rows.shape[-1])
        return float(np.linalg.slogdet(flat.T @ flat)[1])

    assert index(chosen) > index(random) + 5.0


def test_given_poses_are_taken_in_their_order() -> None:
    drawn = [list(one.pose) for one in TrackerValidation().plan(SIX, SMALL).poses][::-1]
    plan = TrackerCalibration().plan(SIX, CalibrationParams(poses=drawn))
    assert [list(one.pose) for one in plan.poses] == drawn


async def test_poses_of_other_names_and_equal_joints_stay_apart() -> None:
    joints = list(TrackerValidation().plan(SIX, SMALL).poses[0].pose)
    given = [GivenPose(pose="first", joints=joints), GivenPose(pose="again", joints=joints)]
    plan = TrackerCalibration().plan(SIX, CalibrationParams(poses=given))
    assert [(one.name, list(one.pose)) for one in plan.poses] == [("first", joints), ("again", joints)]
    dry = DryRunContext(System(SIX), pose=(0.0,) * 6, declared=TrackerCalibration.records)
    await TrackerCalibration().run(dry, plan)
    assert undeclared(dry.prompts, TrackerCalibration) == []


def test_a_pose_that_is_given_twice_is_refused() -> None:
    given = [GivenPose(pose="first", joints=[0.0] * 6)] * 2
    with pytest.raises(PlanError, match="first is given twice: give each pose its own name"):
        TrackerCalibration().plan(SIX, CalibrationParams(poses=given))


def test_a_pose_whose_approach_leaves_the_range_is_named() -> None:
    with pytest.raises(PlanLimitError, match=r"pose P0001: A1 = -169 deg is outside -165"):
        TrackerCalibration().plan(SIX, CalibrationParams(poses=[[-164.0, 0.0, 0.0, 0.0, 0.0, 0.0]]))


def test_a_pose_without_a_seen_target_is_named() -> None:
    with pytest.raises(PlanError, match=r"P0001: the instrument sees no target there.*30 deg"):
        TrackerCalibration().plan(SIX, CalibrationParams(poses=[[-90.0, 0.0, 0.0, 0.0, 0.0, 45.0]]))


def test_a_pose_behind_a_post_is_named() -> None:
    def placed(bench: SerialBench, angle_deg: float) -> SerialBench:
        x, y = (REACH_MM * turn(math.radians(angle_deg)) for turn in (math.cos, math.sin))
        post = Box("post", (x - 20.0, y - 20.0, 0.0), (x + 20.0, y + 20.0, 900.0))
        return replace(bench, workspace=replace(bench.workspace, keep_out=(post,)))

    with pytest.raises(PlanError, match=r"P0001.*post stands in the arm's way"):
        TrackerCalibration().plan(placed(SIX, 45.0), CalibrationParams(poses=[[90.0, 0, 0, 0, 0, 0]]))


def test_what_the_driver_cannot_measure_is_refused() -> None:
    with pytest.raises(PlanError, match="measured = poses"):
        TrackerValidation().plan(SIX, SMALL.model_copy(update={"measured": "poses"}))
    assert TrackerValidation().plan(CMM, ValidationParams(count=3)).measured == "poses"


def test_unknown_targets_are_refused_with_the_known_ones() -> None:
    with pytest.raises(PlanError, match="no target N9: choose among N1, N2, N3"):
        TrackerValidation().plan(SIX, SMALL.model_copy(update={"targets": ["N9"]}))


def test_an_instrument_that_stands_elsewhere_sees_too_little() -> None:
    blind = replace(SIX, instrument=replace(SIX.instrument, cone_deg=0.01))
    with pytest.raises(PlanError, match=r"random poses .* can be measured, too few"):
        TrackerValidation().plan(blind, SMALL)


@pytest.mark.parametrize("frames", [False, True])
async def test_a_rehearsal_drives_the_whole_plan(frames: bool) -> None:
    plan = TrackerValidation().plan(SIX, ValidationParams(count=6, nests_every=4, frames=frames))
    dry = DryRunContext(System(SIX), pose=(0.0,) * 6, declared=TrackerValidation.records)
    await TrackerValidation().run(dry, plan)
    assert undeclared(dry.prompts, TrackerValidation) == []
    dry.require_clear_ways()
    ids = [step.step_id for step in dry.steps]
    assert [one for one in ids if one.startswith("frames")] == (
        ["frames/base", "frames/tool"] if frames else []
    )
    assert [one for one in ids if not one.startswith("frames")] == [
        "nests/00",
        *(f"pose/{number:04d}" for number in range(4)),
        "nests/01",
        *(f"pose/{number:04d}" for number in range(4, 6)),
        "nests/02",
        "summary",
    ]
    assert not [data for kind, data in dry.notes if kind == "warning"]
    if frames:
        # An ideal arm stands where the cell file says.
        found = [data for kind, data in dry.notes if kind == "frame-found"]
        assert [round(float(str(data["shift_mm"])), 6) for data in found] == [0.0, 0.0]
        base, tool = (TrackerValidation.event_texts["frame-found"].text(data) for data in found)
        instrument = SIX.instrument
        assert base.endswith(
            f"base_mm = {[*map(float, instrument.base_mm)]}, base_deg = {[*map(float, instrument.base_deg)]}"
        )
        place = next(one.place_mm for one in SIX.targets if tool.startswith(f"{one.name}: "))
        assert tool.endswith(f"at {[*map(float, place)]} mm")


def test_parameters_have_the_figures_of_the_paper() -> None:
    shared, chosen, random = PoseParams(), CalibrationParams(), ValidationParams()
    assert (shared.approach_deg, shared.dwell_s) == (5.0, 4.0)
    assert (chosen.count, chosen.candidates, random.count) == (38, 5000, 1000)


def test_from_any_other_pose_the_way_leads_over_rest() -> None:
    plan = TrackerValidation().plan(SIX, ValidationParams(count=8))
    for number, planned in enumerate(plan.poses):
        for other in (one for one in plan.poses[:number] if one.pose != planned.free_from):
            way = plan.way_to(planned, other.pose)
            assert way == (other.approach, plan.rest, planned.approach)
            assert way_refusal((other.pose, *way, planned.pose), SIX) is None


def test_many_poses_are_reached_as_each_by_itself() -> None:
    # The gap between bodies that a bench knows to be clear is not asked for twice: each of these is another bench.
    one, other = (
        replace(SIX, workspace=replace(SIX.workspace, clearance_mm=SIX.workspace.clearance_mm + more_mm))
        for more_mm in (0.0, 1e-9)
    )
    low, high = np.array([axis.range for axis in SIX.arm.axes]).T
    poses = [tuple(pose) for pose in np.random.default_rng(4).uniform(low - 10.0, high, (150, 6)).tolist()]
    refusals = [finder_of(one, PoseParams()).refusal(pose) for pose in poses]
    assert {refusal is None for refusal in refusals} == {True, False}
    assert finder_of(other, PoseParams()).reached(poses) == [refusal is None for refusal in refusals]


def test_turns_over_many_poses_are_those_of_each() -> None:
    standing = [tuple(pose) for pose in finder_of(SIX, PoseParams()).drawn(4, 5).tolist()]
    together = list(turns_over(SIX, standing, 6, SIX.targets, 2.0, 300.0, 5.0))
    alone = [next(turns_over(SIX, [pose], 6, SIX.targets, 2.0, 300.0, 5.0)) for pose in standing]
    assert together == alone
    for turn in (turn for turns in together for turn in turns if turn.values_deg):
        poses = np.array([turn.pose(value) for value in turn.values_deg])
        assert seen(SIX, poses, SIX.target(turn.target)).all()
        assert all(SIX.arm.axes[5].allows(value - 5.0) for value in turn.values_deg)


def test_given_rows_of_a_pose_count_its_targets() -> None:
    # All nests look the same way.
    alike = tuple(replace(one, normal=SIX.targets[0].normal) for one in SIX.targets)
    bench = replace(SIX, targets=alike)
    chosen = TrackerValidation().plan(bench, SMALL.model_copy(update={"targets_per_pose": 3})).poses
    assert max(len(one.targets) for one in chosen) == 3
    rows = [list(one.pose) for one in chosen for _ in one.targets]
    assert TrackerCalibration().plan(bench, CalibrationParams(poses=rows)).poses == chosen
    named = [GivenPose(pose=one.name, joints=list(one.pose), rows=len(one.targets)) for one in chosen]
    assert TrackerCalibration().plan(bench, CalibrationParams(poses=named)).poses == chosen
    alone = TrackerCalibration().plan(bench, CalibrationParams(poses=rows, targets_per_pose=1)).poses
    assert [one.targets for one in alone] == [one.targets[:1] for one in chosen]


# All nests look the same way, so that all are seen where one is.
ALIKE = replace(SIX, targets=tuple(replace(one, normal=SIX.targets[0].normal) for one in SIX.targets))


def named_poses(*targets: list[str]) -> list[GivenPose]:
    drawn = TrackerValidation().plan(ALIKE, SMALL).poses
    return [
        GivenPose(pose=one.name, joints=list(one.pose), rows=len(own), targets=own)
        for one, own in zip(drawn, targets, strict=False)
    ]


@pytest.mark.parametrize("procedure", [TrackerCalibration(), TrackerValidation()])
def test_named_targets_of_given_poses_are_measured(
    procedure: TrackerCalibration | TrackerValidation,
) -> None:
    given = named_poses(["N3"], ["N2", "N3"], ["N1"])
    plan = procedure.plan(ALIKE, procedure.params_type(poses=given))  # type: ignore[arg-type]  # its own parameters
    assert [one.targets for one in plan.poses] == [("N3",), ("N2", "N3"), ("N1",)]


def test_a_stated_number_of_targets_goes_before_names() -> None:
    params = CalibrationParams(poses=named_poses(["N3"], ["N2"]), targets_per_pose=1)
    best = [one.targets[:1] for one in TrackerValidation().plan(ALIKE, SMALL).poses[:2]]
    assert [one.targets for one in TrackerCalibration().plan(ALIKE, params).poses] == best


def test_a_named_target_that_the_tool_lacks_is_refused() -> None:
    with pytest.raises(PlanError, match=r"P0002 is to be measured at N7, and the targets are N1, N2, N3"):
        TrackerCalibration().plan(ALIKE, CalibrationParams(poses=named_poses(["N3"], ["N2", "N7"])))


def test_a_named_target_that_is_left_out_is_refused() -> None:
    with pytest.raises(PlanError, match=r"N3, and the targets are N1: .* name it in targets"):
        TrackerCalibration().plan(ALIKE, CalibrationParams(poses=named_poses(["N3"]), targets=["N1"]))


def test_a_named_target_that_looks_away_is_refused() -> None:
    seen = TrackerValidation().plan(SIX, SMALL).poses[0]
    other = next(one.name for one in SIX.targets if one.name not in seen.targets)
    given = GivenPose(pose="first", joints=list(seen.pose), targets=[*seen.targets, other])
    with pytest.raises(PlanError, match=rf"pose first: the instrument does not see {other} there.*30 deg"):
        TrackerCalibration().plan(SIX, CalibrationParams(poses=[given]))


def test_more_targets_at_a_pose_than_there_are_are_refused() -> None:
    with pytest.raises(PlanError, match=r"targets_per_pose = 9, and there are N1, N2, N3 only: .* at most 3"):
        TrackerCalibration().plan(SIX, CalibrationParams(targets_per_pose=9))
    with pytest.raises(PlanError, match=r"targets_per_pose = 2, and there is N2 only: ask for at most 1"):
        TrackerValidation().plan(SIX, ValidationParams(targets=["N2"], targets_per_pose=2))
