"""Cartesian prediction, against Jacobians, absolute kinematics in a loop, and an arm of known joint errors."""

import math
import re

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.inverse import inverse_kinematics
from catseye.calibration.kinematics.jacobian import jacobian
from catseye.calibration.kinematics.rotations import pose_of, rotation_vectors_deg
from catseye.calibration.resolution.cartesian_steps import DIRECTIONS, StepSeries
from catseye.calibration.resolution.predictor import (
    DirectionPrediction,
    PredictionMethod,
    predict_pose,
    unit_of,
)
from catseye.calibration.resolution.tables import ResolutionTables
from tests.unit.calibration.kinematics.chains import chain, poses
from tests.unit.calibration.resolution.invented_arm import KR210, least_step, moved_mm
from tests.unit.calibration.resolution.invented_tables import flat, of_the_invented_arm

ARM = chain("kr210-r2700")
POSE = np.array([20.0, -80.0, 95.0, 15.0, 30.0, -40.0])
POSES = (
    POSE,
    np.array([-35.0, -60.0, 110.0, -40.0, 45.0, 70.0]),
    np.array([60.0, -95.0, 120.0, 25.0, -50.0, 10.0]),
)
TOOL = pose_of(np.array([40.0, 0.0, 180.0]), np.array([0.0, 15.0, 0.0]))
UNITS = np.repeat(np.eye(6), 2, axis=0) * np.tile([1.0, -1.0], 6)[:, None]
SHORT = PredictionMethod(series=StepSeries(count=30))


def named(tables: ResolutionTables, pose: Floats = POSE, **more: object) -> dict[str, DirectionPrediction]:
    found = predict_pose(ARM, pose, tables, **more)  # type: ignore[arg-type]  # whatever the test varies
    return {one.direction: one for one in found}


@settings(max_examples=25)
@given(poses("kr210-r2700"))
@example(np.array([[0.0, -36.5, 16.0, 0.0, 108.0, 0.0]]))
def test_joints_without_errors_make_exact_steps(pose: Floats) -> None:
    for one in predict_pose(ARM, pose[0], flat(ARM), SHORT, TOOL):
        assert np.abs(one.mean_percent).max(initial=0.0) < 1e-5
        assert np.abs(one.across_percent).max(initial=0.0) < 1e-5
        assert one.least.lis is None


@settings(max_examples=25)
@given(poses("kr210-r2700"), st.sampled_from([joint.name for joint in ARM.joints]), st.floats(-50.0, 50.0))
def test_a_scaled_joint_leaves_its_share_of_the_jacobian(pose: Floats, name: str, percent: float) -> None:
    slope = jacobian(ARM, pose, TOOL)[0]
    joint = ARM.frame_of(name) - 1
    if np.linalg.cond(slope) > 1e3:
        return
    tiny = PredictionMethod(series=StepSeries(1e-4, 1e-4, count=11))
    found = predict_pose(ARM, pose[0], flat(ARM, {name: percent}), tiny, TOOL)
    for there, back, unit in zip(found[::2], found[1::2], UNITS[::2], strict=True):
        share = float(unit @ slope[:, joint] * np.linalg.solve(slope, unit)[joint])
        if there.steps.size and back.steps.size:
            # The Jacobian knows no bend of the way, which is the other way round there and back.
            straight = (there.mean_percent + back.mean_percent) / 2.0
            assert straight == pytest.approx(np.full(11, percent * share), abs=1e-3)


def test_errors_are_those_of_absolute_poses_in_a_loop() -> None:
    percent = {"A1": -12.0, "A2": 5.0, "A3": 30.0, "A4": -60.0, "A5": 25.0, "A6": -15.0}
    factors = np.array([1.0 + 0.01 * value for value in percent.values()])
    start = KR210.forward(POSE) @ TOOL
    for one, unit in zip(predict_pose(ARM, POSE, flat(ARM, percent), SHORT, TOOL), UNITS, strict=True):
        for size, mean, across in zip(one.steps, one.mean_percent, one.across_percent, strict=True):
            target = start.copy()
            target[:3, 3] += size * unit[:3]
            target[:3, :3] = pose_of(np.zeros(3), size * unit[3:])[:3, :3] @ start[:3, :3]
            joints = inverse_kinematics(ARM, target[None], POSE, TOOL).required()[0]
            really = KR210.forward(POSE + factors * (joints - POSE)) @ TOOL
            turn = rotation_vectors_deg((really[:3, :3] @ start[:3, :3].T)[None])[0]
            moved = turn if unit_of(one.direction) == "deg" else really[:3, 3] - start[:3, 3]
            along = float(moved @ (unit[:3] + unit[3:]))
            assert mean == pytest.approx(100.0 * (along / size - 1.0), abs=1e-5)
            assert across == pytest.approx(100.0 * math.sqrt(moved @ moved - along**2) / size, abs=1e-3)


def test_scatter_of_draws_is_that_of_the_shares() -> None:
    slope = jacobian(ARM, POSE[None])[0]
    method = PredictionMethod(draws=2000, series=StepSeries(count=11))
    for one, unit in zip(predict_pose(ARM, POSE, flat(ARM, scatter=3.0), method), UNITS, strict=True):
        shares = unit @ slope * np.linalg.solve(slope, unit)
        assert one.std_percent.mean() == pytest.approx(3.0 * np.linalg.norm(shares), rel=0.03)


def test_what_is_unknown_of_a_mean_stays_all_run() -> None:
    steps = PredictionMethod(draws=400)
    alike = named(flat(ARM, u_mean=8.0), method=steps)["+Z"]
    apart = named(flat(ARM, scatter=8.0), method=steps)["+Z"]
    # Eleven steps average their scatter away, so that most runs stay within; what they have in common stays.
    assert alike.std_percent.mean() == pytest.approx(apart.std_percent.mean(), rel=0.1)
    assert "runs are beyond" in alike.least.reason or alike.least.lis is None
    assert apart.least.lis is None
    assert "within ±10 %" in apart.least.reason


@pytest.fixture(scope="module")
def predicted() -> list[dict[str, DirectionPrediction]]:
    return [named(of_the_invented_arm(), pose) for pose in POSES]


def measured_lis(pose: Floats, direction: str, steps: Floats, rng: np.random.Generator) -> float:
    """Return what one run finds: absolute inverse kinematics, each joint with its error, the paper's rule."""
    unit = UNITS[DIRECTIONS.index(direction), :3]
    start = KR210.forward(pose)
    targets = np.repeat(start[None], steps.size, axis=0)
    targets[:, :3, 3] += steps[:, None] * unit
    increments = inverse_kinematics(ARM, targets, pose).required() - pose
    moved = np.array([moved_mm(pose, one, rng) @ unit for one in increments])
    return least_step(steps, 100.0 * (moved / steps - 1.0), 10.0)


@pytest.mark.slow
def test_runs_of_an_arm_find_what_is_predicted(predicted: list[dict[str, DirectionPrediction]]) -> None:
    rng = np.random.default_rng(7)
    hits: list[bool] = []
    for pose, found in zip(POSES, predicted, strict=True):
        for direction in DIRECTIONS[:6]:
            least = found[direction].least
            assert least.lis is not None
            assert least.low is not None
            assert least.high is not None
            for _ in range(5):
                hits.append(
                    least.low <= measured_lis(pose, direction, found[direction].steps, rng) <= least.high
                )
    assert len(hits) == 90
    assert np.mean(hits) >= 0.9


def test_a_prediction_lies_in_its_interval(predicted: list[dict[str, DirectionPrediction]]) -> None:
    ends = [(one.least.low, one.least.lis, one.least.high) for found in predicted for one in found.values()]
    stated = np.array([each for each in ends if None not in each], dtype=np.float64)
    assert len(stated) > 20
    assert (np.diff(stated, axis=1) > 0.0).all()


def test_the_same_seed_gives_the_same_numbers() -> None:
    tables = of_the_invented_arm()
    first, again = named(tables), named(tables)
    other = named(tables, number=1)
    assert (first["+X"].mean_percent == again["+X"].mean_percent).all()
    assert (first["+X"].mean_percent != other["+X"].mean_percent).any()


def without(name: str, direction: int) -> ResolutionTables:
    return ResolutionTables(
        one for one in flat(ARM).tables if (one.joint, one.direction) != (name, direction)
    )


def test_a_joint_that_the_tables_lack_is_named() -> None:
    found = named(without("A2", 1))
    assert found["+X"].least.lis is None
    assert (
        found["+X"].least.reason == "at the first step, 1 mm: the tables hold nothing of A2 in direction +1"
    )
    assert "A2" not in found["-X"].least.reason


def test_a_position_beyond_the_tables_is_named() -> None:
    narrow = ResolutionTables(
        one if one.joint != "A3" else type(one)(one.joint, one.direction, one.sectors[:1])
        for one in flat(ARM).tables
    )
    assert "A3 stands at 95 deg, and its tables hold -120 … -120 deg" in named(narrow)["+X"].least.reason


def test_a_first_step_beyond_the_tables_gives_no_number() -> None:
    least = named(flat(ARM, commands=np.array([1e-9, 1e-3])))["+Z"].least
    assert (least.lis, least.low, least.high) == (None, None, None)
    part = r"at the first step, 1 mm: A\d would step 0\.0\d+ deg, and its table ends at 0\.001 deg"
    assert re.search(part, least.reason)


def test_exact_steps_to_the_tables_end_bound_the_step() -> None:
    found = named(flat(ARM, commands=np.array([1e-2, 10.0])))["+Z"]
    least = found.least
    assert (least.lis, least.low) == (None, 0.0)
    # Half a step of the series above the last one that the tables cover, which is where A2 or A3 would step 0.01 deg.
    assert least.high == pytest.approx(found.steps[-1] * 1.072267**0.5)
    part = r"within ±10 % down to 0\.\d+ mm, where A\d would step 0\.0\d+ deg, and its table begins"
    assert re.search(part, least.reason)


def test_runs_that_scatter_raise_the_upper_end() -> None:
    scattered = named(flat(ARM, scatter=12.0), method=PredictionMethod(draws=400))["+Z"]
    assert scattered.least.lis is None
    assert scattered.least.high is not None
    assert scattered.least.high > 2.0 * scattered.steps[-1]


def test_a_joint_that_hardly_contributes_may_be_unknown() -> None:
    in_plane = np.array([0.01, -80.0, 95.0, 0.0, 30.0, 0.0])
    found = named(without("A1", 1), in_plane)["+X"]
    assert found.steps.size == 109
    # A1 stands still at worst, or turns twice as far.
    slope = jacobian(ARM, in_plane[None])[0]
    share = abs(slope[0, 0] * np.linalg.inv(slope)[0, 0])
    assert 0.0 <= found.std_percent.max() <= 100.0 * share


def test_an_error_beyond_the_threshold_at_once_is_told() -> None:
    everywhere = dict.fromkeys([joint.name for joint in ARM.joints], -20.0)
    least = named(flat(ARM, everywhere))["+X"].least
    assert least.lis is None
    assert least.reason == "the error is -20 % at the first step, 1 mm: the least step is larger"


def test_a_singular_wrist_gives_the_reason() -> None:
    found = named(flat(ARM), np.array([0.0, -80.0, 95.0, 0.0, 0.0, 0.0]))
    assert (
        "cannot make this motion: at this pose its joints move the tool in 5 of 6 ways"
        in found["+Y"].least.reason
    )
    assert found["+X"].steps.size == 109


@pytest.mark.parametrize("pose", [(0.0, -90.0, 90.0, 0.0, 1e-4, 0.0), (0.0, -45.0, -2.0, 0.0, 45.0, 0.0)])
def test_near_a_singular_pose_no_invented_joint_is_named(pose: tuple[float, ...]) -> None:
    found = named(flat(ARM), np.array(pose))
    reasons = {one.least.reason for one in found.values() if "cannot make" in one.least.reason}
    assert any("near a singular pose" in reason for reason in reasons)
    assert not any(re.search(r"would be at|6 of 6", one.least.reason) for one in found.values())


def test_an_arm_of_four_joints_tilts_nothing() -> None:
    arm = chain("rh-3frh5515")
    found = predict_pose(arm, np.array([20.0, 60.0, 100.0, 0.0]), flat(arm))
    assert [one.steps.size for one in found] == [109] * 6 + [0] * 4 + [109] * 2


def test_a_limit_ends_a_direction() -> None:
    at_limit = np.array([20.0, -5.0, 95.0, 15.0, 30.0, -40.0])
    found = named(flat(ARM), at_limit)
    reasons = [found[direction].least.reason for direction in ("+Z", "-Z")]
    assert sum("A2 would be at" in reason and "outside -140…-5 deg" in reason for reason in reasons) == 1


def test_a_pose_beyond_the_limits_is_told_for_all_directions() -> None:
    found = named(flat(ARM), np.array([20.0, 3.0, 95.0, 15.0, 30.0, -40.0]))
    assert {one.least.reason for one in found.values()} == {"A2 would be at 3 deg, outside -140…-5 deg"}


LOST = 0.001
"""deg of each joint."""


def test_a_reversal_takes_its_lost_motion_from_each_step() -> None:
    slope = jacobian(ARM, POSE[None])[0]
    increments = np.linalg.solve(slope, UNITS[4])
    tables = flat(ARM, reversal=LOST)
    found = named(tables, approach=-np.sign(increments).astype(np.int64), method=SHORT)["+Z"]
    kept = np.maximum(1.0 - LOST / np.abs(increments * found.steps[:, None]), 0.0)
    expected = 100.0 * ((slope[2] * increments) @ kept.T - 1.0)
    assert found.mean_percent == pytest.approx(expected, abs=0.01)


def test_joints_that_go_on_lose_nothing() -> None:
    increments = np.linalg.solve(jacobian(ARM, POSE[None])[0], UNITS[4])
    found = named(flat(ARM, reversal=LOST), approach=np.sign(increments).astype(np.int64))["+Z"]
    assert np.abs(found.mean_percent).max() < 1e-6


def test_an_unknown_approach_counts_as_a_reversal() -> None:
    nobody_knows = np.zeros(6, dtype=np.int64)
    assert named(flat(ARM, reversal=LOST), approach=nobody_knows)["+Z"].mean_percent[0] < -1.0


def test_a_reversal_error_that_is_not_known_is_named() -> None:
    found = named(flat(ARM), approach=np.zeros(6, dtype=np.int64))["+Z"]
    assert "reverses, and its reversal error at" in found.least.reason


@pytest.mark.parametrize("wrong", [{"draws": 39}, {"threshold_percent": 0.0}, {"seed": -1}])
def test_a_method_without_a_meaning_is_refused(wrong: dict[str, float]) -> None:
    with pytest.raises(ArgumentError):
        PredictionMethod(**wrong)  # type: ignore[arg-type]  # the wrong ones


def test_a_pose_of_another_arm_is_refused() -> None:
    with pytest.raises(ArgumentError, match="pose: 6 numbers are needed, not 4"):
        predict_pose(ARM, np.zeros(4), flat(ARM))
