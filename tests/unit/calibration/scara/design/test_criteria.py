"""Criteria and their tangents against closed forms and difference quotients."""

from typing import get_args

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.core.design.criteria import CriterionName, covariances
from catseye.calibration.core.design.information import Rows
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.design.criterion import Criterion

NAMES = get_args(CriterionName)
GRADIENT = np.array([[100.0, 0.0, 0.0], [0.0, 300.0, 0.0], [50.0, 50.0, 200.0]])


def matrix(seed: int) -> Floats:
    rows = np.random.default_rng(seed).normal(0.0, 1e3, (9, 3))
    return rows.T @ rows


def test_values_of_a_diagonal_covariance() -> None:
    mdeg = np.deg2rad(1e-3)
    covariance = np.diag([1.0, 4.0, 16.0]) * mdeg**2
    values = {name: Criterion(name, 3, GRADIENT) for name in NAMES}
    shown = {name: one.shown(float(one.value(covariance))) for name, one in values.items()}
    # rms of 1, 2, 4; their geometric mean; the largest; the largest of 100·1, 300·2, √(50²·1 + 50²·4 + 200²·16).
    assert shown["A"] == pytest.approx(np.sqrt(21.0 / 3.0))
    assert shown["D"] == pytest.approx(2.0)
    assert shown["E"] == pytest.approx(4.0)
    assert shown["path"] == pytest.approx(1e3 * mdeg * np.sqrt(2500.0 + 10000.0 + 640000.0))


@pytest.mark.parametrize("name", NAMES)
def test_slope_is_minus_the_derivative_by_the_information(name: CriterionName) -> None:
    criterion, at = Criterion(name, 3, GRADIENT), matrix(1)
    change = matrix(2)
    step = 1e-6
    values = [float(criterion.value(covariances(at + sign * step * change))) for sign in (1.0, -1.0)]
    slope = float(np.sum(criterion.slope(covariances(at)) * change))
    assert (values[0] - values[1]) / (2.0 * step) == pytest.approx(-slope, rel=1e-5)


@given(st.sampled_from(NAMES), st.integers(0, 10_000), st.integers(0, 10_000))
def test_the_tangent_never_exceeds_the_criterion(name: CriterionName, one: int, two: int) -> None:
    criterion = Criterion(name, 3, GRADIENT)
    here, there = matrix(one), matrix(two)
    covariance = covariances(here)
    value, reached = (float(criterion.value(covariances(at))) for at in (here, there))
    bound = value - float(np.sum(criterion.slope(covariance) * (there - here)))
    assert bound <= reached + 1e-7 * (abs(value) + abs(reached) + abs(bound))


@pytest.mark.parametrize("name", NAMES)
def test_a_direction_without_information_is_infinite(name: CriterionName) -> None:
    singular = np.diag([1e9, 1e9, 0.0])
    assert np.isinf(Criterion(name, 3, GRADIENT).value(covariances(singular)))


def test_shared_sources_count_as_in_the_dense_covariance() -> None:
    """What one set of rows says, its nuisance eliminated, against the covariance of all rows."""
    rng = np.random.default_rng(3)
    rows = Rows(rng.normal(size=(20, 3)), rng.normal(size=(20, 2)), rng.normal(size=(20, 4)))
    inverse = np.linalg.inv(np.eye(20) + rows.effects @ rows.effects.T)
    columns = np.hstack([rows.wanted, rows.nuisance])
    expected = np.linalg.inv(columns.T @ inverse @ columns)[:3, :3]
    found = covariances(rows.information().counted(systematic=True))
    assert found == pytest.approx(expected, rel=1e-6)
    white = np.linalg.inv(columns.T @ columns)[:3, :3]
    assert covariances(rows.information().counted(systematic=False)) == pytest.approx(white, rel=1e-6)
