"""The law of propagation on the published examples of the GUM, and on closed forms."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.core.propagation import (
    Inputs,
    correlation,
    coverage_factor,
    effective_dof,
    independent,
    propagate,
    sensitivities,
    type_a,
    type_b,
)
from catseye.calibration.core.types import Floats

# GUM H.2: simultaneous readings of voltage, V, current, A, and phase, rad.
VOLTAGE = [5.007, 4.994, 5.005, 4.990, 4.999]
CURRENT = [19.663e-3, 19.639e-3, 19.640e-3, 19.685e-3, 19.678e-3]
PHASE = [1.0456, 1.0438, 1.0468, 1.0428, 1.0433]

# GUM H.3: readings of a thermometer, °C, and its corrections, °C.
READING = np.array([21.521, 22.012, 22.512, 23.003, 23.507, 23.999, 24.513, 25.002, 25.503, 26.010, 26.511])
CORRECTION = np.array([-171, -169, -166, -159, -164, -165, -156, -157, -159, -161, -160]) * 1e-3


def end_gauge(x: Floats) -> Floats:
    """GUM H.1: length of an end gauge by comparison, nm."""
    standard, mean, random, systematic, alpha, d_alpha, mean_temperature, cyclic, d_theta = x
    theta = mean_temperature + cyclic
    difference = mean + random + systematic
    return np.array([standard + difference - standard * (d_alpha * theta + alpha * d_theta)])


def test_end_gauge_of_gum_h1() -> None:
    u = [25.0, 5.8, 3.9, 6.7, type_b(2e-6, "uniform"), type_b(1e-6, "uniform"), 0.2, type_b(0.5, "arcsine")]
    inputs = independent(
        np.array([50_000_623.0, 215.0, 0.0, 0.0, 11.5e-6, 0.0, -0.1, 0.0, 0.0]),
        np.array([*u, type_b(0.05, "uniform")]),
        np.array([18.0, 24.0, 5.0, 8.0, math.inf, 50.0, math.inf, math.inf, 2.0]),
    )
    found = propagate(end_gauge, inputs)
    assert found.values[0] == pytest.approx(50_000_838.0)
    assert found.u[0] == pytest.approx(31.7, abs=0.05)
    assert found.dof[0] == pytest.approx(16.75, abs=0.05)
    assert found.expanded(0.99)[0] == pytest.approx(91.9, abs=0.2)
    # The published 93 nm takes u = 32 nm, rounded up, and the next lower whole number of degrees of freedom.
    assert round(32.0 * float(coverage_factor(0.99, math.floor(found.dof[0])))) == 93


def impedance(x: Floats) -> Floats:
    voltage, current, phase = x
    ratio = voltage / current
    return np.array([ratio * math.cos(phase), ratio * math.sin(phase), ratio])


def test_resistance_and_reactance_of_gum_h2_from_correlated_readings() -> None:
    found = propagate(impedance, type_a(np.array([VOLTAGE, CURRENT, PHASE])))
    assert found.values == pytest.approx([127.732, 219.847, 254.260], abs=5e-4)
    assert found.u[[0, 2]] == pytest.approx([0.071, 0.236], abs=5e-4)
    # The GUM prints 0.295; its own readings give 0.2956.
    assert found.u[1] == pytest.approx(0.2956, abs=1e-4)
    r = correlation(found.covariance)
    assert [r[0, 1], r[0, 2], r[1, 2]] == pytest.approx([-0.588, -0.485, 0.993], abs=5e-4)


def test_resistance_by_each_simultaneous_set_is_the_other_way_of_gum_h2() -> None:
    each = np.array([impedance(np.array(row)) for row in zip(VOLTAGE, CURRENT, PHASE, strict=True)])
    direct, propagated = type_a(each.T), propagate(impedance, type_a(np.array([VOLTAGE, CURRENT, PHASE])))
    # Both ways print the same; they differ by what is of second order in the readings' scatter.
    assert direct.values == pytest.approx(propagated.values, rel=1e-5)
    assert direct.u == pytest.approx([0.071, 0.2956, 0.236], abs=5e-4)


def line(corrections: Floats) -> Floats:
    """Intercept at 20 °C, slope, and the correction predicted at 30 °C."""
    slope, intercept = np.polyfit(READING - 20.0, corrections, 1)
    return np.array([intercept, slope, intercept + 10.0 * slope])


def test_calibration_line_of_gum_h3() -> None:
    intercept, slope, _ = line(CORRECTION)
    residuals = CORRECTION - intercept - slope * (READING - 20.0)
    dof = READING.size - 2
    scatter = float(np.sqrt(residuals @ residuals / dof))
    found = propagate(line, independent(CORRECTION, np.full(11, scatter), np.full(11, dof)))
    assert found.values == pytest.approx([-0.1712, 0.00218, -0.1494], abs=5e-5)
    assert found.u == pytest.approx([0.0029, 0.00067, 0.0041], abs=6e-5)
    assert correlation(found.covariance)[0, 1] == pytest.approx(-0.930, abs=5e-4)
    # The scatter is one estimate, common to all readings: it has 9 degrees of freedom however many they are.
    assert effective_dof(np.array([found.u[2]]), np.array([dof])) == pytest.approx(9.0)


def test_results_that_share_an_input_are_correlated() -> None:
    found = propagate(
        lambda x: np.array([x[0] + x[1], x[0] - x[1]]), independent(np.ones(2), np.array([3.0, 4.0]))
    )
    assert found.covariance == pytest.approx(np.array([[25.0, -7.0], [-7.0, 25.0]]))


def test_correlated_inputs_add_their_covariance() -> None:
    inputs = Inputs(np.array([1.0, 2.0]), np.array([[4.0, -3.0], [-3.0, 9.0]]), np.full(2, math.inf))
    found = propagate(lambda x: np.array([2.0 * x[0] + 5.0 * x[1]]), inputs)
    assert found.u[0] ** 2 == pytest.approx(4 * 4.0 + 25 * 9.0 + 2 * 2 * 5 * -3.0)
    assert found.dof[0] == math.inf


def test_type_a_is_the_scatter_of_the_mean() -> None:
    one = type_a(np.array([1.0, 2.0, 3.0, 4.0]))
    assert (one.values[0], one.u[0], one.dof[0]) == pytest.approx((2.5, math.sqrt(5.0 / 3.0 / 4.0), 3.0))
    with pytest.raises(ValueError, match="at least two readings"):
        type_a(np.array([1.0]))


@pytest.mark.parametrize(
    ("shape", "u"),
    [("normal", 6.0), ("uniform", 6.0 / 3**0.5), ("triangular", 6.0 / 6**0.5), ("arcsine", 6.0 / 2**0.5)],
)
def test_type_b(shape: str, u: float) -> None:
    assert type_b(6.0, shape) == pytest.approx(u)  # type: ignore[arg-type]  # parametrised by a plain string


def test_an_input_without_uncertainty_has_a_sensitivity() -> None:
    inputs = independent(np.array([3.0, 0.0]), np.array([0.0, 0.0]))
    assert sensitivities(lambda x: np.array([x[0] ** 2 + 7.0 * x[1]]), inputs) == pytest.approx(
        np.array([[6.0, 7.0]]), rel=1e-6
    )
    assert propagate(lambda x: x, inputs).dof.tolist() == [math.inf, math.inf]


@pytest.mark.parametrize(("dof", "k"), [(1, 12.71), (4, 2.78), (10, 2.23), (50, 2.01), (math.inf, 1.960)])
def test_coverage_factors_of_the_t_table(dof: float, k: float) -> None:
    assert float(coverage_factor(0.95, dof)) == pytest.approx(k, abs=0.006)


@given(
    st.lists(st.tuples(st.floats(1e-3, 1e3), st.floats(1.0, 1e4)), min_size=1, max_size=8),
)
def test_effective_dof_lie_between_the_smallest_and_the_sum(parts: list[tuple[float, float]]) -> None:
    u, dof = (np.array(column) for column in zip(*parts, strict=True))
    found = effective_dof(u, dof)
    assert dof.min() * (1 - 1e-9) <= found <= dof.sum() * (1 + 1e-9)
