"""Draws of an identification against single fits and the law of propagation."""

import numpy as np
import pytest

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.estimation import estimate
from catseye.calibration.serial_arm.batched_rows import BatchedArm
from catseye.calibration.serial_arm.identification import Calibration, identify_arm
from catseye.calibration.serial_arm.monte_carlo import chunks, draw_estimates, with_draws
from tests.unit.calibration.serial_arm.nominal import irb120, measured
from tests.unit.calibration.serial_arm.true_arm import random_poses


@pytest.fixture(scope="module")
def found() -> Calibration:
    return identify_arm(irb120(), measured(random_poses(38, 1), 1), "geometric+compliance")


def test_scatter_of_draws_is_that_of_the_jacobian(found: Calibration) -> None:
    drawn = draw_estimates(found, 2000, 3)
    u = np.sqrt(np.diag(found.estimate.covariance))
    assert drawn.fallbacks == 0
    assert drawn.parameters.std(axis=0) / u == pytest.approx(np.ones(len(u)), abs=0.08)
    assert with_draws(found, drawn.parameters).estimate.covariance == pytest.approx(
        np.cov(drawn.parameters.T)
    )


def test_each_draw_is_the_fit_of_its_own_rows(found: Calibration) -> None:
    chunk = chunks(found, 3, 5)[0]
    drawn = draw_estimates(found, 3, 5)
    rng = np.random.Generator(np.random.SFC64(np.random.SeedSequence(5, spawn_key=(0,))))
    u = np.sqrt(np.diag(found.estimate.covariance))
    for errors, solved in zip(chunk.errors.draw(rng, 3), drawn.parameters, strict=True):
        own = BatchedArm(found.model).with_measured(chunk.problem.predicted_mm + errors)
        alone = estimate(own, found.estimate.values).values
        assert np.abs((solved - alone) / u).max() < 1e-4


def test_exact_rows_have_nothing_to_draw() -> None:
    exact = identify_arm(irb120(), measured(random_poses(38, 1)), "geometric+compliance")
    with pytest.raises(CalibrationError, match="nothing is uncertain"):
        draw_estimates(exact, 2, 1)
