"""All checks of one fit together."""

import math

import numpy as np
import pytest

from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis, diagnose
from catseye.calibration.scara.diagnostics.nested_models import Extension, compare_models
from catseye.calibration.scara.extension import crosstalk, j4_map, thermal_drift
from tests.unit.calibration.scara.diagnostics.bench import Extra, commands_on_nodes, measured, problem
from tests.unit.calibration.scara.paper import MDEG, random_truth

TRUTH = random_truth(10)


def diagnosed(extra: Extra | None = None) -> tuple[Diagnosis, list[float]]:
    points = measured(TRUTH, commands_on_nodes(), extra, noise_mm=0.008, sigma_mm=0.008)
    shares: list[float] = []
    return diagnose(problem(points), lambda share, _: shares.append(share)), shares


def test_the_clearest_check_counts_all_others() -> None:
    extra = Extra(theta2=lambda p: 3.0 * MDEG * math.sin(p.theta1))
    points = measured(TRUTH, commands_on_nodes(), extra, noise_mm=0.008, sigma_mm=0.008)
    found = diagnose(problem(points))
    tried = [Extension("crosstalk", crosstalk()), Extension("J4", j4_map()), Extension("t", thermal_drift())]
    alone = next(one for one in compare_models(problem(points), tried) if one.name == "crosstalk")
    together = next(one for one in found.models if "crosstalk" in one.name)
    assert together.significant
    # Fit, outliers, changes, patterns, harmonics, models, reflectors, sweeps: those that are less clear count (Holm).
    raised = together.probability / alone.probability
    assert raised == pytest.approx(round(raised))
    assert 4 <= raised <= 8


def test_a_check_without_a_finding_stays_without_one() -> None:
    found = diagnosed()[0]
    assert found.misfit is not None
    assert found.identified.fit.chi2_probability is not None
    assert 1.0 >= found.misfit >= found.identified.fit.chi2_probability
    assert float(np.abs(found.residuals.external).max()) < found.outlier_limit
    assert not any(one.significant for one in found.models if one.terms)


def test_progress_grows_with_the_work_that_is_done() -> None:
    _, shares = diagnosed()
    assert shares == sorted(shares)
    assert shares[0] == 0.0
    assert 0.9 < shares[-1] < 1.0
    assert len(shares) > 12


def test_a_known_solution_is_not_solved_again() -> None:
    points = measured(TRUTH, commands_on_nodes(), noise_mm=0.008, sigma_mm=0.008)
    posed = problem(points)
    solved = posed.solve()
    assert diagnose(posed, identified=solved).identified is solved
