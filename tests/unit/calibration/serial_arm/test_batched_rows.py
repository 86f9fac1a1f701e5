"""Many draws at once against the rows of a single draw."""

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.rotations import pose_of
from catseye.calibration.serial_arm.arm import Anchor, SerialArm, Target
from catseye.calibration.serial_arm.batched_rows import BatchedArm
from catseye.calibration.serial_arm.closed_form import closed_form
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import parameters_of
from catseye.calibration.serial_arm.measurements import (
    MeasuredDistances,
    MeasuredOrientations,
    MeasuredPoints,
    Measurements,
)
from catseye.calibration.serial_arm.model import ArmModel
from tests.unit.calibration.serial_arm.nominal import irb120
from tests.unit.calibration.serial_arm.true_arm import TrueArm, random_poses

POSES, DRAWS = 30, 4


def mixed() -> tuple[SerialArm, Measurements]:
    """Points with correlated coordinates, orientations of a turned frame, and distances to two anchors."""
    poses, rng = random_poses(POSES, 3), np.random.default_rng(3)
    tool = pose_of(np.array([10.0, -20.0, 90.0]), np.array([30.0, 45.0, -140.0]))
    frames = TrueArm().flange(poses) @ tool
    arm = irb120().with_targets((Target("plate", (9.0, -19.0, 91.0), 0.5, turned=True),))
    half = rng.standard_normal((POSES, 3, 3)) * 0.05
    everywhere, one = np.arange(POSES), np.zeros(POSES, dtype=np.int64)
    anchors = (Anchor("P1", (900.0, 300.0, 100.0), 0.2), Anchor("P2", (0.0, 0.0, 0.0), None))
    places = np.array([[900.0, 300.0, 100.0], [-300.0, 800.0, 200.0]])
    which = everywhere % 2
    apart = np.linalg.norm(frames[:, :3, 3] - places[which], axis=1) - 40.0 * which
    return arm, Measurements(
        Commands.of(arm, poses, rng.choice([-1.0, 1.0], poses.shape)),
        tuple(map(str, range(POSES))),
        MeasuredPoints(everywhere, one, frames[:, :3, 3], half @ half.transpose(0, 2, 1) + 1e-4 * np.eye(3)),
        MeasuredOrientations(everywhere, one, frames[:, :3, :3], np.full(POSES, 0.01)),
        MeasuredDistances(everywhere, one, which, which - 1, apart, np.full(POSES, 0.01), anchors, ("P2#a",)),
    )


def model() -> tuple[ArmModel, Floats]:
    arm, rows = mixed()
    start = closed_form(arm, rows)
    made = ArmModel(arm, start.frame, parameters_of(arm, rows, "maps"), rows)
    sizes = np.array([1e-6 if one.unit.startswith("rad") else 0.3 for one in made.chosen])
    steps = sizes[:, None] * np.random.default_rng(4).standard_normal((len(sizes), DRAWS))
    return made, made.start_values(start)[:, None] + steps


def test_dense_jacobian_is_the_slope_of_the_residuals() -> None:
    arm, rows = mixed()
    start = closed_form(arm, rows)
    made = ArmModel(arm, start.frame, parameters_of(arm, rows, "maps"), rows)
    # Orientations are turned from exactly zero there: beyond, a rotation vector's slope differs from its axis.
    values = made.start_values(start)
    slopes = np.zeros((made.rows, len(values)))
    for k, one in enumerate(made.chosen):
        step = (1e-9 if one.unit.startswith("rad") else 1e-4) * np.eye(len(values))[k]
        slopes[:, k] = (made.residuals(values + step) - made.residuals(values - step)) / (2.0 * step[k])
    unit = np.array([1e-6 if one.unit.startswith("rad") else 1.0 for one in made.chosen])
    turned = slice(3 * POSES, 6 * POSES)
    found, wanted = made.jacobian(values) * unit, slopes * unit
    assert np.delete(found, np.r_[turned], axis=0) == pytest.approx(
        np.delete(wanted, np.r_[turned], axis=0), abs=2e-6
    )
    assert found[turned] == pytest.approx(wanted[turned], abs=0.02)


def test_residuals_are_those_of_single_draws() -> None:
    made, values = model()
    drawn = BatchedArm(made).residuals(values)
    for k in range(DRAWS):
        assert drawn[:, k] == pytest.approx(made.residuals(values[:, k]), abs=1e-9)


def test_gradients_are_those_of_the_dense_jacobian() -> None:
    made, values = model()
    measured = np.random.default_rng(5).standard_normal((made.rows, DRAWS))
    weights = made.weights[:, None] ** 2
    found = BatchedArm(made).gradient(values, measured, lambda residuals: weights * residuals)
    for k in range(DRAWS):
        residuals = made.residuals(values[:, k]) - measured[:, k]
        wanted = made.jacobian(values[:, k]).T @ (weights[:, 0] * residuals)
        assert found[:, k] == pytest.approx(wanted, rel=1e-8, abs=1e-7 * np.abs(wanted).max())


def test_drawn_errors_are_taken_from_the_residuals() -> None:
    made, values = model()
    errors = np.linspace(0.0, 0.1, made.rows)
    drawn = BatchedArm(made).with_measured(errors)
    assert drawn.residuals(values[:, 0]) == pytest.approx(made.residuals(values[:, 0]) - errors)
