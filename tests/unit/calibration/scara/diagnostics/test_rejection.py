"""What is rejected, why, and when nothing is."""

from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.errors import RejectionError
from catseye.calibration.scara.budget_effects import systematic_effects
from catseye.calibration.scara.diagnostics.rejection import reject
from catseye.calibration.scara.points import Points
from catseye.calibration.scara.radial import RadialBudget
from tests.unit.calibration.scara.diagnostics.bench import commands_on_nodes, measured, problem, split
from tests.unit.calibration.scara.paper import random_truth
from tests.unit.calibration.scara.samples import radial_motions

TRUTH = random_truth(4)
COMMANDS = commands_on_nodes()


def with_errors(errors_mm: dict[int, float], seed: int = 1) -> Points:
    points = measured(TRUTH, COMMANDS, noise_mm=0.01, sigma_mm=0.01, seed=seed)
    displacement = points.displacement_mm.copy()
    for row, error in errors_mm.items():
        displacement[row] += error
    return replace(points, displacement_mm=displacement)


def test_only_wrong_distances_are_rejected_with_reasons() -> None:
    wrong = {30: 0.08, 31: 5.0, 500: -0.12, 900: 0.09, 1000: 0.3}
    cleaned = reject(problem(with_errors(wrong)), 5.0)
    assert [one.row for one in cleaned.rejected] == [row + 1 for row in wrong]
    for one, (row, error) in zip(cleaned.rejected, wrong.items(), strict=True):
        a, b, s1, s2 = COMMANDS[row % 352]
        assert (one.theta1_deg, one.theta2_deg, one.direction1, one.direction2) == (a, b, s1, s2)
        assert one.reflector == f"P{row // 352 + 1}"
        assert -one.residual_um == pytest.approx(1e3 * error, abs=45.0)
    text = cleaned.identified.rejected[1]
    assert text.startswith("row 32, reflector P1, segment 0, θ1 ")
    assert "limit 5" in text
    assert len(cleaned.identified.points) == 1056 - 5
    clean = problem(with_errors({}).select(~np.isin(np.arange(1056), list(wrong)))).solve()
    assert cleaned.identified.parameters == pytest.approx(clean.parameters, abs=1e-9)


def test_clean_distances_stay() -> None:
    cleaned = reject(problem(with_errors({})), 5.0)
    assert cleaned.rejected == ()
    assert cleaned.identified.rejected == []


def test_too_many_wrong_distances_question_the_model() -> None:
    rows = np.random.default_rng(3).choice(1056, 80, replace=False)
    with pytest.raises(
        RejectionError, match=r"of 1056 distances .* the 52 that .* the model is in doubt, not"
    ):
        reject(problem(with_errors({int(row): 0.5 for row in rows})), 4.0)


def test_losing_a_whole_segment_keeps_row_numbers() -> None:
    points = split(with_errors({351: 0.4, 700: 0.5}), 349)
    own = np.where(np.arange(1056) < 2, 4, points.dead_path)
    short = replace(points, dead_path=own, dead_paths=(*points.dead_paths, ("P1", 2)))
    cleaned = reject(problem(short), 5.0)
    assert 701 in [one.row for one in cleaned.rejected]


def test_an_outlier_beside_shared_errors_misses_what_others_predict() -> None:
    """Truth: the fit without it, and the dense covariance of its error with those of the others."""
    row = 500
    motions = radial_motions(RadialBudget(0.02, 0.02, 0.04), learnt=True)
    known = replace(problem(with_errors({row: 5.0})), budget=motions)
    (rejected,) = reject(known, 5.0).rejected
    others = np.arange(1056) != row
    without = known.of_rows(others).solve()
    rows = known.solve().model
    residuals = rows.residuals(without.parameters)
    shared = systematic_effects(motions, rows.geometry(without.parameters))
    covariance = np.diag(1.0 / rows.weights**2) + shared @ shared.T
    known_mm = covariance[row, others] @ np.linalg.solve(
        covariance[np.ix_(others, others)], residuals[others]
    )
    # At most 1.345 standard deviations of 10 µm times the leverage of 2 % are what it pulls a Huber fit by.
    assert rejected.residual_um == pytest.approx(1e3 * (residuals[row] - known_mm), abs=0.4)
