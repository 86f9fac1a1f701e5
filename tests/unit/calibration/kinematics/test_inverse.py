"""Inverse kinematics: back by products of exponentials, all branches, limits, and what is refused by name."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from catseye.calibration.kinematics.chain import Chain, Joint
from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.inverse import inverse_kinematics
from catseye.calibration.kinematics.jacobian import jacobian
from catseye.calibration.kinematics.joint_ranges import ranges_of
from catseye.calibration.kinematics.refinement import refine
from catseye.calibration.kinematics.rotations import pose_of
from catseye.calibration.kinematics.spherical_wrist import BRANCHES, SphericalWrist
from catseye.calibration.kinematics.types import Floats
from tests.unit.calibration.kinematics.chains import NAMES, SIX, chain, miss, poses, random_poses
from tests.unit.calibration.kinematics.screws import ARMS

TOOL = pose_of(np.array([120.0, -50.0, 200.0]), np.array([10.0, 20.0, -30.0]))
MISS_MM, MISS = 1e-6, 1e-8
"""The closed form leaves rounding, and Newton ends at 1e-6 mm; where the arm is nearly stretched a cosine next to 1
loses half its digits, which moves the elbow and not the flange."""

KR210_ZERO = np.array([0.0, -90.0, 90.0, 0.0, 0.0, 0.0])


def with_joint(arm: Chain, number: int, **changes: float) -> Chain:
    joints = list(arm.joints)
    joints[number] = replace(joints[number], **changes)  # type: ignore[arg-type]  # names of lengths and angles
    return Chain(tuple(joints))


def require_same_flange(name: str, found: Floats, wanted: Floats) -> None:
    low, high = ranges_of(chain(name))
    for q, target in zip(found, wanted, strict=True):
        apart_mm, apart = miss(ARMS[name].forward(q), target)
        assert apart_mm < MISS_MM
        assert apart < MISS
        assert np.all((q >= low - 2e-6) & (q <= high + 2e-6))


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=60)
@given(data=st.data())
def test_joints_found_from_afar_reach_the_same_flange(name: str, data: st.DataObject) -> None:
    pose = data.draw(poses(name))
    target = ARMS[name].forward(pose[0])[None]
    require_same_flange(
        name,
        inverse_kinematics(chain(name), target, np.mean(ranges_of(chain(name)), axis=0)).required(),
        target,
    )


@pytest.mark.parametrize("name", SIX)
@pytest.mark.parametrize("bend_deg", [1e-9, 5e-8, 1e-7, 4.19e-7, 1e-6, -4.19e-7])
def test_a_wrist_almost_in_line_reaches_the_same_flange(name: str, bend_deg: float) -> None:
    pose = np.mean(ranges_of(chain(name)), axis=0)
    pose[3:] = 40.0, bend_deg, 0.0
    target = ARMS[name].forward(pose)[None]
    for fourth_deg in (-140.0, -50.0, 0.0, 130.0):
        reference = np.array([*pose[:3], fourth_deg, 0.0, 0.0])
        require_same_flange(name, inverse_kinematics(chain(name), target, reference).required(), target)


@pytest.mark.parametrize("beside_mm", [0.0, 1e-12, 5e-8, 8e-7, 1e-5])
def test_a_wrist_almost_above_the_column_is_reached(beside_mm: float) -> None:
    pose = np.array([0.0, -35.0, -60.0, 0.0, 40.0, 0.0])
    target = ARMS["irb120"].forward(pose)
    centre = target[:3, 3] - 72.0 * target[:3, 2]
    target[:2, 3] -= centre[:2] - [beside_mm, 0.0]
    for first_deg in (-90.0, 0.0, 120.0):
        reference = np.array([first_deg, *pose[1:]])
        found = inverse_kinematics(chain("irb120"), target[None], reference).required()
        require_same_flange("irb120", found, target[None])


@pytest.mark.parametrize("name", NAMES)
@settings(max_examples=60)
@given(data=st.data())
def test_a_reference_close_by_gives_its_own_pose(name: str, data: st.DataObject) -> None:
    pose = data.draw(poses(name))
    slopes = jacobian(chain(name), pose)[0]
    assume(np.linalg.svd(slopes / np.linalg.norm(slopes, axis=0), compute_uv=False)[-1] > 0.02)
    low, high = ranges_of(chain(name))
    near = np.clip(pose[0] + 0.1, low, high)
    target = (ARMS[name].forward(pose[0]) @ TOOL)[None]
    solved = inverse_kinematics(chain(name), target, near, TOOL)
    # Rounding of 1e-11 relative, over the smallest singular value.
    assert solved.required() == pytest.approx(pose, abs=1e-7)
    assert not solved.singular


@pytest.mark.parametrize("name", SIX)
def test_all_eight_branches_reach_the_flange(name: str) -> None:
    closed = SphericalWrist.of(chain(name))
    assert closed is not None
    wide = random_poses(name, 40, seed=3)
    targets = np.array([ARMS[name].forward(q) for q in wide])
    found = closed.branches(targets, np.zeros((6, len(wide))))
    sign, offset = np.array([(joint.sign, joint.theta_offset_deg) for joint in chain(name).joints]).T
    whole = 0
    for branch in range(BRANCHES):
        for row in np.flatnonzero(found.reached[branch]):
            q = sign * (np.rad2deg(found.theta[branch, :, row]) - offset)
            apart_mm, apart = miss(ARMS[name].forward(q), targets[row])
            assert apart_mm < MISS_MM
            assert apart < MISS
            whole += 1
    assert whole > 6 * len(wide)
    rows = np.flatnonzero(found.reached.all(axis=0))
    # No two are the same.
    apart = np.abs(np.exp(1j * found.theta[:, None]) - np.exp(1j * found.theta[None])).max(axis=2)[..., rows]
    assert np.all(apart[~np.eye(BRANCHES, dtype=bool)] > 1e-6)


def test_the_branch_nearest_to_the_reference_is_taken() -> None:
    arm = chain("irb120")
    pose = np.array([[20.0, 30.0, -20.0, 40.0, 50.0, 60.0]])
    target = ARMS["irb120"].forward(pose[0])[None]
    flipped = np.array([[20.0, 30.0, -20.0, -140.0, -50.0, -120.0]])
    assert inverse_kinematics(arm, target, pose[0] + 5.0).required() == pytest.approx(pose, abs=1e-9)
    assert inverse_kinematics(arm, target, flipped[0] - 5.0).required() == pytest.approx(flipped, abs=1e-9)


@pytest.mark.parametrize("turned", [-350.0, -10.0, 10.0, 350.0])
def test_whole_turns_follow_the_reference_within_the_range(turned: float) -> None:
    arm = chain("kr210-r2700")
    pose = np.array([10.0, -80.0, 100.0, 30.0, 40.0, turned])
    target = ARMS["kr210-r2700"].forward(pose)[None]
    assert inverse_kinematics(arm, target, pose + 1.0).required()[0] == pytest.approx(pose, abs=1e-9)


def test_a_turn_beyond_the_range_gives_way_to_another() -> None:
    pose = np.add(KR210_ZERO, [0.0, 0.0, 0.0, 30.0, 40.0, 340.0])
    target = ARMS["kr210-r2700"].forward(pose)[None]
    asked = np.add(pose, [0.0, 0.0, 0.0, 0.0, 0.0, 360.0])
    assert inverse_kinematics(chain("kr210-r2700"), target, asked).required()[0] == pytest.approx(
        pose, abs=1e-9
    )


def refused(name: str, target: Floats, reference: Floats) -> str:
    """Return why a target is refused between two that are reached."""
    good = ARMS[name].forward(reference)
    solved = inverse_kinematics(chain(name), np.array([good, target, good]), reference)
    ((row, reason),) = ((one.row, one.reason) for one in solved.refused)
    assert row == 1
    assert np.isnan(solved.poses[1]).all()
    assert np.isfinite(solved.poses[[0, 2]]).all()
    with pytest.raises(KinematicsError, match=re.escape(f"1 of 3 poses are not reached: row 1: {reason}")):
        solved.required()
    return reason


def test_a_place_too_far_is_refused_with_its_distance() -> None:
    target = ARMS["kr210-r2700"].forward(KR210_ZERO)
    target[0, 3] += 1000.0
    away_mm = math.hypot(1550.0 + 1000.0 - 350.0, 1784.0 - 675.0)
    reach_mm = 1150.0 + math.hypot(1200.0, 41.0)
    reason = refused("kr210-r2700", target, KR210_ZERO)
    assert f"the wrist centre is {away_mm:.6g} mm from the axis of A2" in reason
    assert f"…{reach_mm:.6g} mm" in reason


def test_a_place_out_of_range_names_the_joint() -> None:
    pose = np.add(KR210_ZERO, [0.0, 0.0, 0.0, 0.0, 130.0, 0.0])
    target = ARMS["kr210-r2700"].forward(pose)
    assert "A5 would be at 130 deg, outside -125…125 deg" in refused("kr210-r2700", target, KR210_ZERO)


@pytest.mark.parametrize(
    ("pose", "part"),
    [
        ([10.0, 20.0, 160.0, 0.0], "J3 would be at 160 mm, outside 0…150 mm"),
        ([10.0, 20.0, -30.0, 0.0], "J3 would be at -30 mm"),
    ],
)
def test_a_stroke_that_is_too_short_is_named(pose: list[float], part: str) -> None:
    target = ARMS["rh-3frh5515"].forward(np.array(pose))
    assert part in refused("rh-3frh5515", target, np.array([0.0, 60.0, 50.0, 0.0]))


def test_a_scara_says_that_it_does_not_tilt() -> None:
    reference = np.array([0.0, 60.0, 50.0, 0.0])
    tilted = ARMS["rh-3frh5515"].forward(reference) @ pose_of(np.zeros(3), np.array([5.0, 0.0, 0.0]))
    reason = refused("rh-3frh5515", tilted, reference)
    assert re.search(r"no joints found for it; the nearest pose is .* mm and 5 deg away", reason)


def test_more_refusals_than_fit_are_counted() -> None:
    target = np.tile(pose_of(np.array([9000.0, 0.0, 0.0]), np.zeros(3)), (8, 1, 1))
    with pytest.raises(KinematicsError, match=r"8 of 8 poses .*row 4: .*; and 3 more"):
        inverse_kinematics(chain("irb120"), target, np.zeros(6)).required()


@pytest.mark.parametrize(
    ("name", "pose", "part"),
    [
        ("kr210-r2700", [0.0, -90.0, 90.0, 25.0, 0.0, -10.0], "A4 and A6 are in line, and A4 stays"),
        ("irb120", [30.0, 20.0, -math.degrees(math.atan2(302.0, 70.0)), 10.0, 20.0, 30.0], "stretched"),
        ("rh-3frh5515", [30.0, 0.0, 50.0, 20.0], "the arm is singular"),
    ],
)
def test_singular_poses_are_reached_and_named(name: str, pose: list[float], part: str) -> None:
    q = np.array(pose)
    target = ARMS[name].forward(q)[None]
    solved = inverse_kinematics(chain(name), target, q)
    require_same_flange(name, solved.required(), target)
    ((row, reason),) = ((one.row, one.reason) for one in solved.singular)
    assert row == 0
    assert part in reason
    # Half the digits of a cosine next to 1.
    assert solved.poses[0] == pytest.approx(q, abs=1e-5)


def test_the_first_joint_stays_where_the_wrist_is_above_it() -> None:
    # The wrist centre of the IRB 120 on the axis of J1: 270 sin(q2) + 302 cos + 70 sin of q2 + q3 is 0.
    elbow = math.radians(-40.0)
    ahead = 302.0 * math.cos(elbow) + 70.0 * math.sin(elbow)
    lift = math.atan2(ahead, -(270.0 + 70.0 * math.cos(elbow) - 302.0 * math.sin(elbow)))
    q = np.array([35.0, math.degrees(lift) - 180.0, -40.0, 10.0, 50.0, 20.0])
    target = ARMS["irb120"].forward(q)[None]
    solved = inverse_kinematics(chain("irb120"), target, q)
    require_same_flange("irb120", solved.required(), target)
    assert "both shoulders are the same" in solved.singular[0].reason
    assert solved.poses[0] == pytest.approx(q, abs=1e-5)


@pytest.mark.parametrize(
    "changes",
    [
        {1: {"alpha_deg": 90.0}, 3: {"alpha_deg": 90.0}, 4: {"alpha_deg": -90.0}},
        {1: {"d_mm": 70.0}, 2: {"d_mm": -25.0}},
        {0: {"alpha_deg": 30.0, "a_mm": 40.0}},
        {2: {"alpha_deg": 180.0, "d_mm": 15.0}},
        {5: {"alpha_deg": 90.0, "d_mm": -80.0}},
        {3: {"alpha_deg": -70.0}},
    ],
)
def test_the_closed_form_holds_for_other_arms_of_its_kind(changes: dict[int, dict[str, float]]) -> None:
    arm = chain("irb120")
    for number, change in changes.items():
        arm = with_joint(arm, number, **change)
    assert SphericalWrist.of(arm) is not None
    wide = random_poses("irb120", 200, seed=5)
    targets = arm.frames(wide)[-1]
    found = inverse_kinematics(arm, targets, np.zeros(6)).required()
    apart_mm, apart = miss(arm.frames(found)[-1], targets)
    assert apart_mm < MISS_MM
    assert apart < MISS


@pytest.mark.parametrize(
    ("number", "change"),
    [(4, {"a_mm": 5.0}), (2, {"alpha_deg": 0.05}), (4, {"d_mm": 0.2}), (1, {"alpha_deg": -89.9})],
)
def test_an_arm_as_it_was_made_is_solved_by_newton(number: int, change: dict[str, float]) -> None:
    arm = with_joint(chain("kr210-r2700"), number, **change)
    assert SphericalWrist.of(arm) is None
    wide = random_poses("kr210-r2700", 60, seed=6)
    near = np.clip(wide + np.random.default_rng(7).normal(0.0, 2.0, wide.shape), *ranges_of(arm))
    targets = arm.frames(wide)[-1]
    found = inverse_kinematics(arm, targets, near).required()
    apart_mm, apart = miss(arm.frames(found)[-1], targets)
    assert apart_mm < MISS_MM
    assert apart < MISS


def test_rows_of_many_poses_keep_their_numbers_and_references() -> None:
    arm, wide = chain("kr210-r2700"), random_poses("kr210-r2700", 5000, seed=11)
    targets = arm.flange(wide)
    targets[[17, 4321], :3, 3] *= 5.0
    solved = inverse_kinematics(arm, targets, wide)
    assert [named.row for named in solved.refused] == [17, 4321]
    reached = np.delete(np.arange(5000), [17, 4321])
    # Beside singular places rounding moves single joints by more than it moves the flange.
    assert np.median(np.abs(solved.poses[reached] - wide[reached])) < 1e-10
    apart_mm, apart = miss(arm.flange(solved.poses[reached]), targets[reached])
    assert apart_mm < MISS_MM
    assert apart < MISS


def test_no_poses_give_no_joints() -> None:
    assert inverse_kinematics(chain("irb120"), np.empty((0, 4, 4)), np.zeros(6)).required().shape == (0, 6)
    assert inverse_kinematics(chain("rh-3frh5515"), np.empty((0, 4, 4)), np.zeros(4)).required().shape == (
        0,
        4,
    )


def test_references_without_a_meaning_are_refused() -> None:
    target = ARMS["irb120"].flange[None]
    with pytest.raises(KinematicsError, match=r"reference: shape \(4,\) instead of \(6,\)"):
        inverse_kinematics(chain("irb120"), target, np.zeros(4))
    with pytest.raises(KinematicsError, match="reference: a joint is not finite"):
        inverse_kinematics(chain("irb120"), target, np.full(6, np.nan))


SEVEN = Chain(
    tuple(
        Joint(f"A{n}", "revolute", alpha_deg, 0.0, 0.0, d_mm, 1.0, -170.0, 170.0)
        for n, (alpha_deg, d_mm) in enumerate(
            [
                (0.0, 360.0),
                (-90.0, 0.0),
                (90.0, 420.0),
                (90.0, 0.0),
                (-90.0, 400.0),
                (-90.0, 0.0),
                (90.0, 126.0),
            ],
            1,
        )
    )
)


def test_an_arm_of_seven_joints_stays_near_its_reference() -> None:
    near = np.array([10.0, 30.0, -20.0, 70.0, 15.0, 60.0, 5.0])
    wanted = SEVEN.frames(near[None])[-1]
    wanted[0, :3, 3] += [20.0, -10.0, 5.0]
    found = inverse_kinematics(SEVEN, wanted, near).required()
    apart_mm, apart = miss(SEVEN.frames(found)[-1], wanted)
    assert apart_mm < MISS_MM
    assert apart < MISS
    # The smallest change of the joints that does it, to first order, and 6 deg squared beside it.
    smallest = np.linalg.pinv(jacobian(SEVEN, near[None])[0]) @ [20.0, -10.0, 5.0, 0.0, 0.0, 0.0]
    assert np.linalg.norm(found[0] - near - smallest) < 0.2 * np.linalg.norm(smallest)


def test_newton_steps_from_given_joints_stay_on_their_branch() -> None:
    arm = chain("irb120")
    wide = random_poses("irb120", 300, seed=9)
    wide[:, 4] = 40.0 * np.sign(wide[:, 4])
    wide[:, 2] = np.clip(wide[:, 2], -60.0, 40.0)
    wide[:, 1] = np.clip(wide[:, 1], -100.0, -30.0)
    started = wide + np.random.default_rng(1).normal(0.0, 0.2, wide.shape)
    found = refine(arm, arm.frames(wide)[-1] @ TOOL, started, TOOL)
    assert found.reached.all()
    assert found.miss_mm.max() < MISS_MM
    assert found.poses == pytest.approx(wide, abs=1e-6)


def test_newton_says_by_how_much_it_misses() -> None:
    arm = chain("irb120")
    target = pose_of(np.array([[0.0, 0.0, 2000.0]]), np.zeros((1, 3)))
    ended = refine(arm, target, np.zeros((1, 6)))
    # Stretched upwards the flange is at 290 + 270 + sqrt(70² + 302²) + 72 mm at most.
    assert not ended.reached[0]
    assert ended.miss_mm[0] >= 2000.0 - 632.0 - math.hypot(70.0, 302.0) - 1e-6
