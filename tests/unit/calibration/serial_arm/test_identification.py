"""Identification of a serial arm against an arm that is computed by screws."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.errors import InsufficientPointsError, UnidentifiableError
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.rotations import pose_of
from catseye.calibration.serial_arm.arm import Anchor, Target
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import Calibration, identify_arm
from catseye.calibration.serial_arm.measurements import (
    MeasuredDistances,
    MeasuredOrientations,
    MeasuredPoints,
    Measurements,
)
from tests.unit.calibration.serial_arm.nominal import irb120, measured, validation
from tests.unit.calibration.serial_arm.true_arm import DRAWN, NESTS, TrueArm, random_poses, torques_nmm


def errors_mm(found: Calibration) -> Floats:
    """Return how far a calibration misses nest 1 on poses that it has not seen."""
    poses, places = validation()
    missed = found.places_mm(Commands.of(irb120(), poses), 0) - places
    return np.asarray(np.linalg.norm(missed, axis=1))


def values(found: Calibration) -> dict[str, float]:
    names = [one.name for one in found.model.chosen]
    return dict(zip(names, found.estimate.values.tolist(), strict=True))


def test_torques_agree_with_slopes_of_the_energy() -> None:
    poses = random_poses(20, 3)
    assert irb120().torques_nmm(poses) == pytest.approx(torques_nmm(poses), abs=1e-3)


def test_nominal_arm_misses_as_the_paper_says() -> None:
    poses = random_poses(1000, 5)
    nest = np.arange(1000) % 3
    missed = np.linalg.norm(TrueArm().nests(poses, nest) - DRAWN.nests(poses, nest), axis=1)
    assert missed.mean() == pytest.approx(2.6, abs=0.2)
    assert missed.max() == pytest.approx(5.5, abs=0.6)


def test_noise_free_points_give_the_arm_exactly() -> None:
    found = identify_arm(irb120(), measured(random_poses(38, 1)), "geometric+compliance")
    assert errors_mm(found).max() < 1e-8
    assert values(found)["J4.compliance_rad_per_nmm"] == pytest.approx(0.605e-6, rel=1e-6)
    assert values(found)["J6.d_mm"] == pytest.approx(72.05, abs=1e-6)


def test_base_may_stand_anywhere() -> None:
    motion = pose_of(np.array([2000.0, -900.0, 400.0]), np.array([170.0, 89.9, -120.0]))
    still = measured(random_poses(38, 1))
    places = still.points.place_mm @ motion[:3, :3].T + motion[:3, 3]
    moved = replace(still, points=replace(still.points, place_mm=places))
    found = identify_arm(irb120(), moved, "geometric+compliance")
    poses, wanted = validation()
    seen = found.places_mm(Commands.of(irb120(), poses), 0)
    assert np.abs(seen - (wanted @ motion[:3, :3].T + motion[:3, 3])).max() < 1e-8


def test_stated_uncertainty_holds_on_unseen_places() -> None:
    poses, places = validation()
    commands, ratios = Commands.of(irb120(), poses), []
    for seed in range(12):
        found = identify_arm(irb120(), measured(random_poses(38, seed), seed), "geometric+compliance")
        missed = found.places_mm(commands, 0) - places
        u = np.sqrt(np.diagonal(found.covariance_of_places(commands, 0), axis1=1, axis2=2))
        ratios.append(np.mean((missed / u) ** 2))
    assert np.sqrt(np.mean(ratios)) == pytest.approx(1.0, abs=0.15)


def test_without_compliance_the_fit_is_rejected() -> None:
    found = identify_arm(irb120(), measured(random_poses(38, 2), 2), "geometric")
    assert found.estimate.fit.chi2_probability is not None
    assert found.estimate.fit.chi2_probability < 1e-6


def test_offset_of_parallel_axes_is_no_parameter_of_its_own() -> None:
    found = identify_arm(irb120(), measured(random_poses(38, 1)), "geometric+compliance")
    assert "J3.d_mm" not in values(found)
    assert "J3.beta_deg" in values(found)


def test_unknown_targets_hold_what_they_share_with_the_last_joint() -> None:
    arm = irb120()
    unknown = arm.with_targets(
        tuple(replace(one, place_mm=(0.0, 0.0, 0.0), u_mm=None) for one in arm.targets)
    )
    found = identify_arm(unknown, measured(random_poses(60, 1)), "geometric+compliance")
    held = {parameter.name for parameter, _ in found.model.held}
    assert held == {"J6.theta_offset_deg", "J6.d_mm"}
    assert {names[-1] for names in found.null_directions} == held
    assert errors_mm(found).max() < 1e-7


def test_places_known_roughly_are_weighed_with_the_rows() -> None:
    arm = irb120()
    rough = arm.with_targets(tuple(replace(one, u_mm=0.2) for one in arm.targets))
    shifted = rough.with_targets((Target("nest1", (0.3, 0.0, 125.0), 0.2), *rough.targets[1:]))
    found = identify_arm(shifted, measured(random_poses(60, 4), 4), "geometric+compliance")
    assert errors_mm(found).mean() < 0.06


def test_poses_that_show_too_little_are_refused_by_name() -> None:
    poses = random_poses(38, 1)
    poses[:, 4] = 30.0
    with pytest.raises(UnidentifiableError, match="J5"):
        identify_arm(irb120(), measured(poses), "geometric+compliance")


def test_fewer_rows_than_parameters_are_refused() -> None:
    with pytest.raises(InsufficientPointsError, match="27 rows for 31 parameters"):
        identify_arm(irb120(), measured(random_poses(9, 1)), "geometric+compliance")


def test_distances_to_unknown_anchors_give_the_arm() -> None:
    poses = random_poses(240, 1)
    nest = np.zeros(len(poses), dtype=np.int64)
    places = TrueArm(base=np.zeros(6)).nests(poses, nest)
    anchors = np.array([[900.0, 300.0, 100.0], [-200.0, 1000.0, 300.0], [700.0, -800.0, 900.0]])
    which = np.arange(len(poses)) % 3
    apart = np.linalg.norm(places - anchors[which], axis=1) - np.array([100.0, 50.0, 0.0])[which]
    rows = MeasuredDistances(
        np.arange(len(poses)),
        nest,
        which,
        np.array([0, 1, -1])[which],
        apart,
        None,
        tuple(Anchor(f"P{k}", u_mm=None) for k in range(3)),
        ("P0#1", "P1#1"),
    )
    commands = Commands.of(irb120(), poses)
    found = identify_arm(
        irb120(), Measurements(commands, tuple(map(str, range(240))), distances=rows), "geometric+compliance"
    )
    assert {parameter.name for parameter, _ in found.model.held} >= {"base.x_mm", "base.rz_deg"}
    assert values(found)["P0#1.dead_path_mm"] == pytest.approx(100.0, abs=1e-4)
    assert np.abs(found.estimate.residuals_mm).max() < 1e-6


def test_whole_poses_give_the_arm() -> None:
    poses = random_poses(30, 6)
    frames = TrueArm().flange(poses)
    tool = (Target("plate", (0.0, 0.0, 0.0)),)
    arm = irb120().with_targets(tool)
    everywhere = np.arange(30), np.zeros(30, dtype=np.int64)
    rows = Measurements(
        Commands.of(arm, poses),
        tuple(map(str, range(30))),
        MeasuredPoints(*everywhere, frames[:, :3, 3]),
        MeasuredOrientations(*everywhere, frames[:, :3, :3]),
    )
    found = identify_arm(arm, rows, "geometric+compliance")
    assert found.estimate.residuals_mm == pytest.approx(0.0, abs=1e-7)
    assert values(found)["J6.alpha_deg"] == pytest.approx(-89.969, abs=1e-7)


def test_orientation_of_an_unknown_frame_is_found() -> None:
    poses = random_poses(30, 6)
    tool = pose_of(np.array([10.0, -20.0, 90.0]), np.array([30.0, 95.0, -140.0]))
    frames = TrueArm().flange(poses) @ tool
    arm = irb120().with_targets((Target("plate", (0.0, 0.0, 0.0), None, turned=True),))
    everywhere = np.arange(30), np.zeros(30, dtype=np.int64)
    rows = Measurements(
        Commands.of(arm, poses),
        tuple(map(str, range(30))),
        MeasuredPoints(*everywhere, frames[:, :3, 3]),
        MeasuredOrientations(*everywhere, frames[:, :3, :3]),
    )
    found = identify_arm(arm, rows, "geometric+compliance")
    assert found.estimate.residuals_mm == pytest.approx(0.0, abs=1e-7)
    held = {parameter.name for parameter, _ in found.model.held}
    assert {"J6.theta_offset_deg", "J6.d_mm"} <= held


def test_correlated_coordinates_count_as_their_covariance_says() -> None:
    poses, rng = random_poses(60, 8), np.random.default_rng(8)
    along = np.array([0.6, 0.64, 0.48])
    covariance = 0.5**2 * np.outer(along, along) + 0.01**2 * np.eye(3)
    clean = measured(poses)
    noise = rng.multivariate_normal(np.zeros(3), covariance, len(poses))
    points = replace(
        clean.points,
        place_mm=clean.points.place_mm + noise,
        covariance_mm2=np.tile(covariance, (len(poses), 1, 1)),
    )
    weighed = identify_arm(irb120(), replace(clean, points=points), "geometric+compliance")
    plain = identify_arm(
        irb120(), replace(clean, points=replace(points, covariance_mm2=None)), "geometric+compliance"
    )
    assert weighed.estimate.fit.chi2_reduced == pytest.approx(1.0, abs=0.35)
    assert errors_mm(weighed).mean() < 0.5 * errors_mm(plain).mean()


@pytest.mark.parametrize("part", range(len(NESTS)))
def test_every_nest_is_predicted(part: int) -> None:
    found = identify_arm(irb120(), measured(random_poses(38, 1)), "geometric+compliance")
    poses = random_poses(10, 77)
    wanted = TrueArm().nests(poses, np.full(10, part))
    assert found.places_mm(Commands.of(irb120(), poses), part) == pytest.approx(wanted, abs=1e-8)
