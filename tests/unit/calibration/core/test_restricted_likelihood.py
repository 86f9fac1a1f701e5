"""Sizes of a shared error, where the rows allow them to be compared at all."""

import numpy as np
import pytest

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.restricted_likelihood import restricted_log_likelihoods
from catseye.calibration.core.whitening import Whitening


def test_weights_that_hide_one_another_are_refused() -> None:
    # One row in nanometres among others in tens of micrometres, by a mistake of the unit.
    rng = np.random.default_rng(3)
    weights = np.where(np.arange(60) % 12 == 0, 1e12, 20.0)
    jacobian = rng.normal(size=(60, 12))
    effects = np.kron(np.eye(20), np.ones((3, 1))).astype(np.float64)
    with pytest.raises(CalibrationError, match="differ by so many orders of magnitude"):
        restricted_log_likelihoods(
            Whitening.of(weights), jacobian, rng.normal(0.0, 0.05, 60), effects, (0.0, 0.1, 1.0)
        )


def test_weights_that_are_all_too_large_are_refused_as_such() -> None:
    # Parameters move the rows as what they share does; beside that it is lost what each is off by itself.
    rng = np.random.default_rng(3)
    effects = np.kron(np.eye(20), np.ones((3, 1))).astype(np.float64)
    jacobian = effects @ rng.normal(size=(20, 12))
    with pytest.raises(CalibrationError, match="uncertainties of the rows, 1e-12 mm, are so many orders"):
        restricted_log_likelihoods(
            Whitening.of(np.full(60, 1e12)), jacobian, rng.normal(0.0, 0.05, 60), effects, (0.0, 1.0)
        )
