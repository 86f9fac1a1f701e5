"""Stated uncertainties against the scatter of estimates from repeated measurements of one arm."""

from dataclasses import replace
from functools import cache

import numpy as np

from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.points import Commands
from catseye.calibration.scara.prediction import predict
from tests.unit.calibration.scara.paper import (
    paper_points,
    random_truth,
)
from tests.unit.calibration.scara.samples import identified

TRUTH = random_truth(6)
SIGMA_MM = 0.0156
DRAWS = 300


@cache
def draws() -> list[Identification]:
    """Return the arm as repeated measurements of it find it, which differ in their white errors."""
    exact = paper_points(TRUTH, sigma_mm=SIGMA_MM)
    found = []
    for seed in range(DRAWS):
        noise = np.random.default_rng(seed).normal(0.0, SIGMA_MM, len(exact))
        points = replace(exact, displacement_mm=exact.displacement_mm + noise)
        found.append(identified(points))
    return found


def test_stated_uncertainties_are_honest_for_white_noise() -> None:
    errors = [(one.parameters[:40] - TRUTH.table_vector()) / one.standard_uncertainty[:40] for one in draws()]
    chi2 = [one.fit.chi2_reduced for one in draws() if one.fit.chi2_reduced is not None]
    assert len(chi2) == DRAWS
    assert 0.9 < float(np.sqrt(np.mean(np.square(errors)))) < 1.1
    assert 0.9 < float(np.mean(chi2)) < 1.1
    # A reduced χ² of about 1000 degrees of freedom scatters by 4.5 %: one of 60 is hardly ever off by 15 %.
    assert min(chi2[:60]) > 0.85
    assert max(chi2[:60]) < 1.15


def test_covariance_agrees_with_repeated_draws() -> None:
    estimates = [one.parameters[:40] for one in draws()]
    ratio = np.std(estimates, axis=0) / draws()[-1].standard_uncertainty[:40]
    assert 0.97 < float(np.mean(ratio)) < 1.03
    assert float(ratio.min()) > 0.85
    assert float(ratio.max()) < 1.15


def test_prediction_uncertainty_agrees_with_repeated_draws() -> None:
    commands = Commands(
        np.deg2rad([-35.0, 12.0]), np.deg2rad([33.0, 97.0]), np.array([1, -1]), np.array([-1, 1])
    )
    predicted = [predict(one.arm, commands, 325.0, 225.0) for one in draws()]
    scatter = np.std([one.position_mm for one in predicted], axis=0)
    assert np.abs(scatter / predicted[-1].u_mm - 1.0).max() < 0.2
