"""ISO 9283 against figures worked out by hand, and spreads of positions against draws."""

import math

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.stats import bartlett

from catseye.calibration.core.errors import InsufficientPointsError, UnidentifiableError
from catseye.calibration.standards.iso9283 import pose_repeatability
from catseye.calibration.standards.repeatability import (
    along_beam,
    conditioning,
    equal_variances,
    in_plane,
    interval_of_s,
)

Floats = NDArray[np.float64]


def one_segment(values_mm: list[float]) -> tuple[Floats, NDArray[np.int64], NDArray[np.int64]]:
    count = len(values_mm)
    return np.array(values_mm), np.zeros(count, dtype=np.int64), np.arange(count)


def test_repeatability_of_positions_worked_out_by_hand() -> None:
    attained = np.array(
        [(3, 4, 0), (3, 4, 12), (3, -8, 0), (-9, 4, 0), (3, 4, -12), (3, 16, 0), (15, 4, 0)], dtype=np.float64
    )
    assert pose_repeatability(attained) == pytest.approx(23.8924353, abs=1e-7)
    six = np.vstack([np.eye(3), -np.eye(3)])
    assert pose_repeatability(six + np.array([6.0, 2.0, 3.0])) == pytest.approx(1.0, abs=1e-12)


def test_repeatability_along_a_beam_worked_out_by_hand() -> None:
    found = along_beam(*one_segment([500.02, 500.01, 499.99, 500.00, 500.03]))
    assert found.rp_um == pytest.approx(47.4342, abs=1e-4)
    assert found.mean_mm == pytest.approx(500.01)
    assert found.range_um == pytest.approx(40.0)
    assert (found.arrivals, found.dof) == (5, 4)


def test_interval_of_a_standard_deviation_as_tables_have_it() -> None:
    # χ² for 29 degrees of freedom: 16.047 and 45.722; for 4: 0.4844 and 11.143.
    assert interval_of_s(29) == pytest.approx((math.sqrt(29 / 45.722), math.sqrt(29 / 16.047)), rel=1e-4)
    assert interval_of_s(4) == pytest.approx((math.sqrt(4 / 11.143), math.sqrt(4 / 0.4844)), rel=1e-4)
    found = along_beam(*one_segment([500.02, 500.01, 499.99, 500.00, 500.03]))
    assert found.s_low_um == pytest.approx(15.8114 * 0.5991, rel=1e-3)
    assert found.s_high_um == pytest.approx(15.8114 * 2.8736, rel=1e-3)


def test_the_interval_has_its_stated_coverage() -> None:
    rng = np.random.default_rng(1)
    held = 0
    for _ in range(2000):
        found = along_beam(*one_segment(list(rng.normal(0.0, 0.010, 10))))
        held += found.s_low_um <= 10.0 <= found.s_high_um
    # 95 % of 2000 draws, with a standard deviation of 10.
    assert 1900 - 40 < held < 1900 + 40


def test_segments_are_pooled_and_each_costs_a_degree_of_freedom() -> None:
    values = np.array([0.000, 0.002, 7.001, 7.003, 7.005, -3.0])
    segment = np.array([0, 0, 1, 1, 1, 2])
    found = along_beam(values, segment, np.arange(6))
    # Squares about the segments' means, µm²: 1 + 1, 4 + 0 + 4, 0.
    assert found.s_um == pytest.approx(math.sqrt(10.0 / 3.0))
    assert (found.arrivals, found.dof) == (6, 3)
    assert found.range_um == pytest.approx(4.0)
    assert found.segment == 1
    assert found.mean_mm == pytest.approx(7.003)


def test_pooled_spread_is_not_biased_by_the_number_of_segments() -> None:
    rng = np.random.default_rng(2)
    squares = []
    for _ in range(400):
        segment = np.repeat(np.arange(10), 3)
        values = rng.normal(0.0, 0.010, 30) + rng.normal(0.0, 50.0, 10)[segment]
        squares.append(along_beam(values, segment, np.arange(30)).s_um ** 2)
    # Each square has 20 degrees of freedom: 100 ± 32 µm², the mean of 400 ± 1.6.
    assert float(np.mean(squares)) == pytest.approx(100.0, abs=6.0)


def test_no_two_arrivals_with_one_dead_path_are_refused() -> None:
    with pytest.raises(InsufficientPointsError, match="3 arrivals in 3 segments have no spread"):
        along_beam(np.array([1.0, 2.0, 3.0]), np.array([0, 1, 2]), np.arange(3))


def test_a_drift_is_reported_with_its_significance() -> None:
    rng = np.random.default_rng(3)
    cycle = np.arange(30)
    values = 1e-3 * cycle + rng.normal(0.0, 0.002, 30)
    segment = np.where(cycle < 12, 0, 1)
    found = along_beam(values + np.where(segment == 1, 40.0, 0.0), segment, cycle)
    assert found.drifts
    # The slope has a standard deviation of 2 µm / sqrt(143 + 484.5), 29 cycles of it 2.3 µm.
    assert found.drift_um == pytest.approx(29.0, abs=7.0)
    assert found.drift_probability is not None
    assert found.drift_probability < 1e-6


def test_false_drifts_are_as_rare_as_stated() -> None:
    rng = np.random.default_rng(4)
    found = [along_beam(*one_segment(list(rng.normal(0.0, 0.010, 30)))).drifts for _ in range(2000)]
    # 1 % of 2000 is 20 with a standard deviation of 4.4.
    assert 4 < sum(found) < 38


def test_two_arrivals_have_no_drift() -> None:
    found = along_beam(*one_segment([1.0, 1.002]))
    assert (found.drift_um, found.drift_probability) == (None, None)
    assert not found.drifts
    still = along_beam(*one_segment([1.0, 1.0, 1.0]))
    assert (still.s_um, still.drift_um) == (0.0, 0.0)
    assert not still.drifts


def s_along(covariance: Floats, direction_rad: Floats) -> Floats:
    unit = np.stack([np.cos(direction_rad), np.sin(direction_rad)])
    return np.asarray(np.sqrt(np.einsum("ik,ij,jk->k", unit, covariance, unit)))


@pytest.mark.parametrize("angles_deg", [[0.0, 60.0, 120.0], [-30.0, 0.0, 35.0], [10.0, 80.0, 130.0, 200.0]])
def test_three_beams_give_the_covariance_back(angles_deg: list[float]) -> None:
    truth = np.array([[120.0, 35.0], [35.0, 60.0]])
    direction = np.radians(angles_deg)
    found = in_plane(direction, s_along(truth, direction), np.full(len(angles_deg), 29))
    assert found.covariance_um2 == pytest.approx(truth)
    assert found.assumption == ""


@pytest.mark.parametrize(
    "truth", [np.diag([100.0, 100.0]), np.array([[120.0, 35.0], [35.0, 60.0]]), np.diag([81.0, 1.0])]
)
def test_rp_is_that_of_positions_drawn_from_the_covariance(truth: Floats) -> None:
    direction = np.radians([0.0, 60.0, 120.0])
    found = in_plane(direction, s_along(truth, direction), np.full(3, 29))
    drawn = np.random.default_rng(5).multivariate_normal([0.0, 0.0], truth, 200_000)
    assert found.rp_um == pytest.approx(pose_repeatability(drawn), rel=0.01)


def test_stated_uncertainty_of_rp_is_what_draws_scatter_by() -> None:
    truth = np.array([[120.0, 35.0], [35.0, 60.0]])
    direction, rng = np.radians([0.0, 60.0, 120.0]), np.random.default_rng(6)
    drawn = []
    for _ in range(500):
        s = s_along(truth, direction) * np.sqrt(rng.chisquare(99, 3) / 99)
        drawn.append(in_plane(direction, s, np.full(3, 99)).rp_um)
    stated = in_plane(direction, s_along(truth, direction), np.full(3, 99)).u_rp_um
    assert float(np.std(drawn)) == pytest.approx(stated, rel=0.12)


def test_two_beams_need_an_assumption_and_say_so() -> None:
    round_spread = in_plane(np.radians([10.0, 60.0]), np.array([10.0, 10.0]), np.array([29, 29]))
    assert round_spread.covariance_um2 == pytest.approx(np.diag([100.0, 100.0]))
    # E l = σ sqrt(π/2), sd l = σ sqrt(2 − π/2) of a round normal distribution.
    assert round_spread.rp_um == pytest.approx(
        10.0 * (math.sqrt(math.pi / 2) + 3 * math.sqrt(2 - math.pi / 2))
    )
    assert "roundest" in round_spread.assumption
    crossed = in_plane(np.radians([0.0, 90.0]), np.array([12.0, 5.0]), np.array([29, 29]))
    assert crossed.covariance_um2 == pytest.approx(np.diag([144.0, 25.0]))
    direction = np.radians([20.0, 70.0])
    any_two = in_plane(direction, np.array([9.0, 7.0]), np.array([29, 29]))
    assert s_along(any_two.covariance_um2, direction) == pytest.approx([9.0, 7.0])


def test_variances_that_no_spread_has_are_refused() -> None:
    with pytest.raises(UnidentifiableError, match=r"standard deviations 2\.0, 10\.0, 2\.0 µm"):
        in_plane(np.radians([-40.0, 0.0, 40.0]), np.array([2.0, 10.0, 2.0]), np.full(3, 29))
    with pytest.raises(UnidentifiableError, match="no spread"):
        in_plane(np.radians([0.0, 20.0]), np.array([20.0, 1.0]), np.full(2, 29))


def test_scatter_of_a_round_arm_is_seldom_refused() -> None:
    # Least squares alone find no spread for every fifth of these poses.
    direction, rng = np.radians([-35.0, 0.0, 35.0]), np.random.default_rng(7)
    errors, refused = [], 0
    for _ in range(1000):
        s = 10.0 * np.sqrt(rng.chisquare(9, 3) / 9)
        try:
            found = in_plane(direction, s, np.full(3, 9))
        except UnidentifiableError:
            refused += 1
            continue
        if "round spread" in found.assumption:
            # RP of a round normal distribution: E l = σ sqrt(π/2), sd l = σ sqrt(2 − π/2).
            rp_um = 10.0 * (math.sqrt(math.pi / 2) + 3 * math.sqrt(2 - math.pi / 2))
            errors.append((found.rp_um - rp_um) / found.u_rp_um)
    assert refused < 20
    assert len(errors) > 150
    assert float(np.sqrt(np.mean(np.square(errors)))) == pytest.approx(1.0, abs=0.15)


def test_equal_variances_are_tested_as_bartlett_does() -> None:
    rng = np.random.default_rng(8)
    samples = [rng.normal(0.0, sigma, size) for sigma, size in ((1.0, 30), (1.3, 12), (0.8, 20))]
    s = np.array([sample.std(ddof=1) for sample in samples])
    dof = np.array([sample.size - 1 for sample in samples])
    assert equal_variances(s, dof) == pytest.approx(float(bartlett(*samples).pvalue))
    assert equal_variances(np.array([0.0, 1.0]), np.array([9, 9])) == 0.0


def test_parallel_beams_and_a_single_one_are_refused() -> None:
    with pytest.raises(UnidentifiableError, match="too nearly parallel"):
        in_plane(np.radians([10.0, 191.0]), np.array([10.0, 10.0]), np.full(2, 29))
    with pytest.raises(UnidentifiableError, match="too nearly parallel"):
        in_plane(np.radians([0.0, 90.0, 91.0]), np.array([10.0, 10.0, 10.0]), np.full(3, 29))
    with pytest.raises(InsufficientPointsError, match="one beam"):
        in_plane(np.array([0.0]), np.array([10.0]), np.array([29]))
    assert conditioning(np.radians([0.0, 60.0, 120.0])) == pytest.approx(math.sqrt(1.5))


def test_an_arm_without_scatter_has_rp_zero() -> None:
    found = in_plane(np.radians([0.0, 60.0, 120.0]), np.zeros(3), np.full(3, 29))
    assert found.rp_um == 0.0
    assert found.u_rp_um == 0.0


def test_equal_readings_have_no_spread_by_rounding() -> None:
    readings = np.full(10, 0.1)
    assert along_beam(readings, np.zeros(10, dtype=np.int64), np.arange(10)).s_um == 0.0
