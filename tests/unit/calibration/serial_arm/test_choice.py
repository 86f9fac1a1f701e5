"""Wrong poses, a drifting base, joints read back, and which model is taken."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.errors import RejectionError
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.choice import Chosen, choose
from catseye.calibration.serial_arm.fitted import without_wrong_poses
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.held_out import predicted_errors_mm
from catseye.calibration.serial_arm.identification import ModelName, identify_arm
from catseye.calibration.serial_arm.left_out_poses import parts_of, predict_left_out, same_command
from catseye.calibration.serial_arm.measurements import MeasuredPoints, Measurements
from tests.unit.calibration.serial_arm.nominal import NOISE_MM, irb120, measured, validation
from tests.unit.calibration.serial_arm.true_arm import COMPLIANCE, NOMINAL, TrueArm, random_poses

POSES = 60


def shifted(shifts_mm: dict[int, tuple[float, float, float]]) -> Floats:
    moved = np.zeros((POSES, 3))
    for pose, shift in shifts_mm.items():
        moved[pose] = shift
    return moved


def mean_miss_mm(found: Chosen) -> float:
    poses, places = validation()
    missed = found.calibration.places_mm(Commands.of(irb120(), poses), 0) - places
    return float(np.linalg.norm(missed, axis=1).mean())


def test_predicted_errors_are_those_of_fits_without_the_pose() -> None:
    rows = measured(random_poses(POSES, 1), 1)
    found = identify_arm(irb120(), rows, "geometric+compliance")
    for pose in (0, 17):
        kept = np.arange(POSES) != pose
        quick = predicted_errors_mm(found.model, found.estimate.values, ~kept)
        without = identify_arm(irb120(), rows.at(kept), "geometric+compliance")
        at_it = rows.commands.some(np.array([pose]))
        missed = without.places_mm(at_it, int(rows.points.target[pose])) - rows.points.place_mm[pose]
        # The quick way is linear about the estimate.
        assert quick[pose] == pytest.approx(float(np.linalg.norm(missed)), rel=1e-3)
        assert np.isnan(quick[kept]).all()


def test_wrong_poses_are_named_and_no_others() -> None:
    moved = shifted({3: (0.4, -0.2, 0.1), 40: (0.0, 5.0, 0.0)})
    _, rejected = without_wrong_poses(
        irb120(), measured(random_poses(POSES, 2), 2, moved_mm=moved), "geometric+compliance"
    )
    assert sorted(one.name for one in rejected) == ["pose 4", "pose 41"]


def test_wrong_pose_with_the_only_rows_of_a_target_goes() -> None:
    arm = irb120()
    arm = arm.with_targets((*arm.targets[:2], replace(arm.targets[2], u_mm=None)))
    poses = random_poses(POSES, 2)
    pose, nest = np.append(np.arange(POSES), 5), np.append(np.arange(POSES) % 2, 2)
    places = TrueArm().nests(poses[pose], nest)
    places = places + NOISE_MM * np.random.default_rng(2).standard_normal(places.shape)
    places[5] += 0.0, 5.0, 0.0
    covariance = np.tile(NOISE_MM**2 * np.eye(3), (len(pose), 1, 1))
    names = tuple(f"pose {k + 1}" for k in range(POSES))
    rows = Measurements(Commands.of(arm, poses), names, MeasuredPoints(pose, nest, places, covariance))
    found, rejected = without_wrong_poses(arm, rows, "geometric+compliance")
    assert [one.name for one in rejected] == ["pose 6"]
    assert not any(one.name.startswith("nest3") for one in found.model.chosen)


def of_all_nests(poses: Floats, real: Floats, seed: int) -> Measurements:
    """Measure three nests at each pose; the arm stands at other joints than commanded."""
    pose, nest = np.repeat(np.arange(len(poses)), 3), np.tile(np.arange(3), len(poses))
    places = TrueArm().nests(real[pose], nest)
    places = places + NOISE_MM * np.random.default_rng(seed).standard_normal(places.shape)
    covariance = np.tile(NOISE_MM**2 * np.eye(3), (len(pose), 1, 1))
    names = tuple(f"pose {k + 1}" for k in range(len(poses)))
    return Measurements(Commands.of(irb120(), poses), names, MeasuredPoints(pose, nest, places, covariance))


def test_poses_that_scatter_as_a_whole_are_kept_and_weighed() -> None:
    poses = random_poses(100, 1)
    real = poses + 0.015 * np.random.default_rng(1).standard_normal(poses.shape)
    found = choose(irb120(), of_all_nests(poses, real, 1), name="geometric+compliance")
    assert len(found.rejected) <= 1
    assert found.scatter_mm is not None
    # What 0.015° of each joint move a nest by, rms of a coordinate.
    apart = TrueArm().nests(real, np.zeros(100, dtype=np.int64)) - TrueArm().nests(
        poses, np.zeros(100, dtype=np.int64)
    )
    assert found.scatter_mm == pytest.approx(float(np.sqrt(np.mean(apart**2))), rel=0.5)


def test_a_robust_loss_states_nothing_that_it_did_not_use() -> None:
    poses = random_poses(60, 1)
    rows = of_all_nests(poses, poses + 0.015 * np.random.default_rng(1).standard_normal(poses.shape), 1)
    aside = np.zeros((len(rows.points.pose), 3))
    aside[rows.points.pose == 7] = 0.0, 3.0, 4.0
    rows = replace(rows, points=replace(rows.points, place_mm=rows.points.place_mm + aside))
    found = choose(irb120(), rows, name="geometric", loss="huber")
    assert (found.rejected, found.drift_mm, found.scatter_mm) == ((), None, None)
    for used in (found.calibration, found.frames):
        assert np.unique(used.model.measurements.poses).size == 60
    assert np.unique(found.held_out.pose).size == 60


def test_poses_at_one_command_are_left_out_together() -> None:
    poses = np.repeat(random_poses(POSES // 2, 10), 2, axis=0)
    rows = measured(poses, 10)
    parts = parts_of(rows, same_command(rows))
    assert np.sum(parts, axis=0).tolist() == [1] * POSES
    assert all((part[::2] == part[1::2]).all() for part in parts)


@pytest.mark.parametrize("name", ["geometric+compliance", "maps"])
def test_pose_left_out_changes_nothing_that_predicts_it(name: ModelName) -> None:
    rows = measured(random_poses(40, 11), 11)
    aside = np.zeros((40, 3))
    aside[7] = 0.0, 3.0, 4.0
    moved = replace(rows, points=replace(rows.points, place_mm=rows.points.place_mm + aside))
    command = same_command(rows)
    left_out = next(part for part in parts_of(rows, command) if part[7])
    before, after = (
        predict_left_out(irb120(), one, (name,), command).errors_mm[name] for one in (rows, moved)
    )
    beside = left_out & (np.arange(40) != 7)
    assert after[beside] == pytest.approx(before[beside], abs=1e-9)
    assert after[7] == pytest.approx(5.0, abs=0.5)


def test_target_that_one_pose_shows_is_not_predicted() -> None:
    arm = irb120()
    spare = replace(arm.targets[2], u_mm=None)
    arm = arm.with_targets((*arm.targets[:2], spare))
    rows = measured(random_poses(40, 12), 12)
    nest = np.where(np.arange(40) == 5, 2, np.arange(40) % 2)
    points = replace(rows.points, target=nest, place_mm=TrueArm().nests(random_poses(40, 12), nest))
    rows = replace(rows, points=points)
    predicted = predict_left_out(arm, rows, ("geometric",), same_command(rows)).errors_mm["geometric"]
    assert np.flatnonzero(np.isnan(predicted)).tolist() == [5]


def test_model_beyond_what_the_poses_carry_is_not_compared() -> None:
    found = choose(irb120(), measured(random_poses(24, 13), 13))
    maps = found.candidates[-1]
    assert maps.mean_mm is None
    assert maps.effective is not None
    assert maps.effective > 36.0
    assert "effective parameters from 72 coordinates" in maps.reason


def test_simplest_model_within_one_standard_error_is_taken() -> None:
    found = choose(irb120(), measured(random_poses(POSES, 6), 6))
    within = [
        one.name
        for one in found.candidates
        if one.behind_mm is not None and one.u_behind_mm is not None and one.behind_mm <= one.u_behind_mm
    ]
    assert found.calibration.name == within[0]
    assert min(one.behind_mm for one in found.candidates if one.behind_mm is not None) == 0.0


def test_wrong_pose_is_named_where_joints_have_maps() -> None:
    wavy = TrueArm(wave_deg=np.full(6, 0.04))
    aside = np.zeros((2 * POSES, 3))
    aside[30] = 0.3, 0.3, -0.3
    rows = measured(random_poses(2 * POSES, 9), 9, wavy, aside)
    _, rejected = without_wrong_poses(irb120(), rows, "maps")
    assert [one.name for one in rejected] == ["pose 31"]


def test_exact_repetition_shows_no_scatter() -> None:
    poses = random_poses(60, 2)
    assert choose(irb120(), of_all_nests(poses, poses, 2), name="geometric+compliance").scatter_mm is None


def test_too_many_wrong_poses_are_refused() -> None:
    # A third of the poses stands a millimetre aside, each in a direction of its own.
    aside = np.random.default_rng(3).standard_normal((POSES, 3)) * (np.arange(POSES) % 3 == 0)[:, None]
    with pytest.raises(RejectionError, match="contradict the model"):
        without_wrong_poses(
            irb120(), measured(random_poses(POSES, 3), 3, moved_mm=aside), "geometric+compliance"
        )


def test_a_drifting_base_is_seen_and_hardly_costs() -> None:
    drift = np.linspace(-0.5, 0.5, POSES)[:, None] * np.array([0.1, -0.1, 0.05])
    found = choose(irb120(), measured(random_poses(POSES, 4), 4, moved_mm=drift), name="geometric+compliance")
    still = choose(irb120(), measured(random_poses(POSES, 4), 4), name="geometric+compliance")
    # 0.1, 0.1 and 0.05 mm in the coordinates from first to last.
    assert found.drift_mm == pytest.approx(0.0866, rel=0.35)
    assert still.drift_mm is None
    assert mean_miss_mm(found) < 1.5 * mean_miss_mm(still)


@pytest.mark.parametrize("moves", ["commanded", "read back"])
def test_joints_that_moved_the_arm_are_taken(moves: str) -> None:
    commanded = random_poses(POSES, 5)
    read = commanded + np.random.default_rng(5).uniform(-0.05, 0.05, commanded.shape)
    true = commanded if moves == "commanded" else read
    rows = measured(true, 5)
    rows = replace(rows, commands=Commands.of(irb120(), commanded))
    found = choose(irb120(), rows, read, "geometric+compliance")
    assert found.joints == moves


def test_elastic_arm_is_taken_for_elastic() -> None:
    found = choose(irb120(), measured(random_poses(POSES, 6), 6))
    assert found.calibration.name == "geometric+compliance"
    assert found.held_out.mean_mm < 3.0 * NOISE_MM
    assert {one.name for one in found.candidates} == {"frames", "geometric", "geometric+compliance", "maps"}


def test_rigid_arm_is_taken_for_rigid() -> None:
    rigid = TrueArm(compliance=np.zeros(6))
    found = choose(irb120(), measured(random_poses(POSES, 7), 7, rigid))
    assert found.calibration.name == "geometric"


def test_perfect_arm_needs_frames_only() -> None:
    perfect = TrueArm(NOMINAL, np.zeros(6))
    found = choose(irb120(), measured(random_poses(POSES, 8), 8, perfect))
    assert found.calibration.name == "frames"


def test_waves_of_the_joints_are_taken_for_maps() -> None:
    wavy = TrueArm(compliance=COMPLIANCE, wave_deg=np.full(6, 0.04))
    found = choose(irb120(), measured(random_poses(2 * POSES, 9), 9, wavy))
    assert found.calibration.name == "maps"
    values = dict(
        zip(
            [one.name for one in found.calibration.model.chosen],
            found.calibration.estimate.values,
            strict=True,
        )
    )
    assert values["J4.sin1_deg"] == pytest.approx(0.04, abs=0.015)
