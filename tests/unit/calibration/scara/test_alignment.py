"""Offset and pitch of the beam against geometry of the test's own."""

import cmath
import math

import numpy as np
import pytest

from catseye.calibration.core.errors import InsufficientPointsError, UnidentifiableError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.alignment import fit_offset, fit_pitch


def length_of(turn_rad: float, distance_mm: float, offset_mm: float) -> float:
    """Return the length from where the beam is abreast of the J4 axis to where it is abreast of the reflector.

    The beam is a ray that starts `offset` to its left of the axis at the origin. It is first pointed so that it
    passes through the reflector at (distance, 0), then turned about the axis.
    """
    pointed = -math.asin(offset_mm / distance_mm)
    direction = cmath.exp(1j * (pointed + turn_rad))
    start = 1j * offset_mm * direction
    return ((distance_mm - start) * direction.conjugate()).real


def lengths(turns: Floats, distance_mm: float, offset_mm: float) -> Floats:
    return np.array([length_of(float(turn), distance_mm, offset_mm) for turn in turns])


def test_the_test_beam_meets_the_reflector_before_it_is_turned() -> None:
    direction = cmath.exp(-1j * math.asin(0.7 / 200.0))
    aside = ((200.0 - 0.7j * direction) * direction.conjugate()).imag
    assert aside == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize("offset", [0.43, -0.43, 0.0, 2.5])
@pytest.mark.parametrize("distance", [130.0, 800.0])
def test_the_slope_is_the_offset_with_its_side(offset: float, distance: float) -> None:
    turns = np.linspace(-0.8, 0.8, 21) / distance
    fit = fit_offset(turns, lengths(turns, distance, offset), np.zeros(21, dtype=np.int64), 0.0)
    # The slope's own error is of third order in the turn.
    assert fit.offset_mm == pytest.approx(offset, abs=1e-4)
    assert fit.curvature_mm == pytest.approx(-math.sqrt(distance**2 - offset**2) / 2.0, rel=1e-4)
    assert fit.plausible_at(distance, 1.0)


def test_a_shift_between_passes_changes_nothing() -> None:
    turns = np.concatenate([np.linspace(-0.006, 0.006, 15), np.linspace(0.006, -0.006, 15)])
    series = np.repeat(np.array([0, 1], dtype=np.int64), 15)
    shifted = lengths(turns, 130.0, 0.3) + np.where(series == 1, 0.050, 0.0)
    assert fit_offset(turns, shifted, series, 0.0).offset_mm == pytest.approx(0.3, abs=1e-4)
    joined = fit_offset(turns[:-4], shifted[:-4], np.zeros(26, dtype=np.int64), 0.0)
    assert abs(joined.offset_mm - 0.3) > 0.05


def test_stated_uncertainty_matches_the_scatter_of_fits() -> None:
    rng = np.random.default_rng(7)
    turns = np.linspace(-0.006, 0.006, 21)
    series = np.zeros(21, dtype=np.int64)
    clean = lengths(turns, 130.0, 0.2)
    fits = [fit_offset(turns, clean + rng.normal(0.0, 1e-4, 21), series, 0.0) for _ in range(400)]
    scatter = float(np.std([fit.offset_mm for fit in fits]))
    # σ / sqrt(Σ φ²), the textbook's formula for the slope of symmetrical turns.
    assert scatter == pytest.approx(1e-4 / math.sqrt(float(turns @ turns)), rel=0.12)
    assert float(np.mean([fit.u_mm for fit in fits])) == pytest.approx(scatter, rel=0.12)


def test_noise_that_is_stated_larger_than_the_scatter_counts() -> None:
    turns = np.linspace(-0.006, 0.006, 21)
    fit = fit_offset(turns, lengths(turns, 130.0, 0.2), np.zeros(21, dtype=np.int64), 1e-3)
    assert fit.u_mm == pytest.approx(1e-3 / math.sqrt(float(turns @ turns)), rel=1e-6)


def test_a_curvature_of_another_length_is_not_plausible() -> None:
    turns = np.linspace(-0.006, 0.006, 21)
    fit = fit_offset(turns, lengths(turns, 130.0, 0.2), np.zeros(21, dtype=np.int64), 1e-6)
    assert not fit.plausible_at(200.0, 30.0)
    moving = lengths(turns, 130.0, 0.2) + 3e3 * turns**2
    assert not fit_offset(turns, moving, np.zeros(21, dtype=np.int64), 1e-6).plausible_at(130.0, 30.0)


def test_too_few_turns_are_refused() -> None:
    with pytest.raises(InsufficientPointsError, match="4 lengths cannot determine 4 unknowns"):
        fit_offset(np.arange(4.0), np.zeros(4), np.array([0, 0, 1, 1]), 1e-4)
    with pytest.raises(UnidentifiableError, match="J4 was not turned"):
        fit_offset(np.zeros(9), np.zeros(9), np.zeros(9, dtype=np.int64), 1e-4)


def test_the_pitch_and_its_heights() -> None:
    distance = np.array([200.0, 500.0, 900.0])
    # The beam leaves J4 at height J3 + h and rises by 1.5 mm in a metre; the reflector's centre stands at 80 mm.
    beam_above_j3, pitch, centre = 28.0, 0.0015, 80.0
    height = centre - beam_above_j3 - pitch * distance
    fit = fit_pitch(distance, height, 0.01)
    assert fit.pitch_rad == pytest.approx(0.0015)
    assert fit.height_mm(500.0) == pytest.approx(80.0 - 28.0 - 0.75)
    assert fit.axis_height_mm == pytest.approx(52.0)
    mean = float(distance.mean())
    assert fit.u_pitch_rad == pytest.approx(0.01 / math.sqrt(float(np.sum((distance - mean) ** 2))))
    assert fit.u_height_mm(mean) == pytest.approx(0.01 / math.sqrt(3.0))


def test_two_distances_have_the_stated_uncertainty() -> None:
    fit = fit_pitch(np.array([200.0, 700.0]), np.array([50.0, 49.0]), 0.02)
    assert fit.pitch_rad == pytest.approx(0.002)
    assert fit.u_pitch_rad == pytest.approx(0.02 * math.sqrt(2.0) / 500.0)


def test_heights_off_the_line_widen_the_uncertainty() -> None:
    fit = fit_pitch(np.array([200.0, 500.0, 800.0]), np.array([50.0, 50.5, 50.0]), 0.01)
    assert fit.u_pitch_rad > 5 * 0.01 / math.hypot(300.0, 300.0)


def test_one_distance_has_no_pitch() -> None:
    with pytest.raises(InsufficientPointsError, match="two distances"):
        fit_pitch(np.array([300.0]), np.array([50.0]), 0.01)
    with pytest.raises(UnidentifiableError, match="nearer and farther"):
        fit_pitch(np.array([300.0, 300.0]), np.array([50.0, 50.0]), 0.01)
