"""The judgement of a comparison against dense algebra and against repeated draws."""

import math

import numpy as np
import pytest
from scipy import stats

from catseye.calibration.core.budget import Shared, White
from catseye.calibration.core.errors import UnidentifiableError
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.agreement import Agreement, agreement
from catseye.calibration.scara.comparison import compare, rigid_fit
from catseye.calibration.scara.prediction_errors import PredictionErrors

ROWS = 30
COMMAND = np.random.default_rng(1).uniform(-400.0, 400.0, (ROWS, 2))
EFFECTS = np.random.default_rng(2).normal(0.0, 0.004, (ROWS, 2, 5))
U_MM = np.linspace(0.004, 0.012, ROWS)
EVERY = np.ones(ROWS, dtype=np.bool_)
TURN = math.radians(25.0)
ROTATION = np.array([[math.cos(TURN), -math.sin(TURN)], [math.sin(TURN), math.cos(TURN)]])


def errors(effects: Floats) -> PredictionErrors:
    return PredictionErrors((), (Shared("prediction", effects.reshape(-1, effects.shape[2])),))


def drawn(rng: np.random.Generator, grow: float = 1.0) -> Agreement:
    """Return the judgement of an arm whose prediction and instrument err by what they state, times a factor."""
    wrong = EFFECTS @ rng.standard_normal(5)
    noise = rng.standard_normal((ROWS, 2)) * U_MM[:, None]
    seen = (COMMAND - grow * wrong + grow * noise - np.array([900.0, 1200.0])) @ ROTATION
    return agreement(compare(COMMAND, COMMAND, seen, EVERY), errors(EFFECTS), U_MM)


def dense() -> Floats:
    """Return the covariance W of what an alignment about the positions' mean leaves over."""
    effects = EFFECTS.reshape(2 * ROWS, -1)
    whole = effects @ effects.T + np.diag(np.repeat(U_MM**2, 2))
    columns = np.zeros((ROWS, 2, 3))
    columns[:, 0, 0] = columns[:, 1, 1] = 1.0
    centred = COMMAND - COMMAND.mean(axis=0)
    columns[:, 0, 2], columns[:, 1, 2] = -centred[:, 1], centred[:, 0]
    flat = columns.reshape(-1, 3)
    projector = np.eye(2 * ROWS) - flat @ np.linalg.pinv(flat)
    return np.asarray(projector @ whole @ projector)


def test_expectation_and_degrees_of_freedom_are_those_of_dense_algebra() -> None:
    found, expected = drawn(np.random.default_rng(3)), dense()
    trace = float(np.trace(expected))
    # The alignment is linear about the measured positions there and about the commands here: 0.05 mm in 400 mm.
    assert found.expected_um == pytest.approx(1e3 * math.sqrt(trace / ROWS), rel=1e-4)
    # Eigenvalues are those to first order in what the instrument's uncertainties differ by, ±50 % here.
    assert found.dof == pytest.approx(trace**2 / float(np.sum(expected**2)), rel=0.1)
    assert found.u_mm.ravel() == pytest.approx(np.sqrt(np.diag(expected)), rel=1e-4)
    assert found.instrument


def test_draws_of_what_is_stated_agree_with_it() -> None:
    rng = np.random.default_rng(4)
    found = [drawn(rng) for _ in range(400)]
    assert float(np.mean([1.0 / one.share for one in found])) == pytest.approx(1.0, abs=0.05)
    assert float(np.mean([one.within for one in found])) == pytest.approx(0.954, abs=0.01)
    # Probabilities are uniform as far as the saddlepoint of a sum of squares makes them so.
    assert stats.kstest([one.probability for one in found], "uniform").pvalue > 0.01
    assert sum(not one.agrees for one in found) < 14


def test_the_parts_of_the_expectation_add_up() -> None:
    rng = np.random.default_rng(8)
    scatter = White("repeatability", np.full(2 * ROWS, 0.010))
    stated = PredictionErrors((scatter,), errors(EFFECTS).shared)
    seen = COMMAND + 0.01 * rng.standard_normal((ROWS, 2))
    found = agreement(compare(COMMAND, COMMAND, seen, EVERY), stated, U_MM)
    assert list(found.parts_um) == ["prediction", "repeatability", "instrument"]
    assert math.hypot(*found.parts_um.values()) == pytest.approx(found.expected_um)
    # An alignment takes three of the 2 n coordinates' freedoms up.
    assert found.parts_um["repeatability"] == pytest.approx(10.0 * math.sqrt(2.0 - 3.0 / ROWS), rel=1e-6)


def test_larger_errors_than_stated_are_seen() -> None:
    rng = np.random.default_rng(5)
    found = [drawn(rng, grow=3.0) for _ in range(20)]
    assert all(not one.agrees for one in found)
    assert float(np.mean([1.0 / one.share for one in found])) == pytest.approx(9.0, rel=0.3)


def test_the_uncertainties_of_the_alignment_are_its_scatter() -> None:
    rng, fits = np.random.default_rng(6), []
    for _ in range(400):
        wrong = EFFECTS @ rng.standard_normal(5)
        seen = (
            COMMAND + rng.standard_normal((ROWS, 2)) * U_MM[:, None] - np.array([900.0, 1200.0])
        ) @ ROTATION
        fits.append(rigid_fit(seen, COMMAND + wrong))
    found = drawn(rng)
    turns = [fit.rotation_rad for fit in fits]
    assert float(np.mean(turns)) == pytest.approx(TURN, abs=1e-5)
    assert found.u_rotation_rad == pytest.approx(float(np.std(turns)), rel=0.12)
    assert found.u_shift_mm == pytest.approx(np.std([fit.shift_mm for fit in fits], axis=0), rel=0.12)


def test_an_instrument_that_states_nothing_counts_as_nothing() -> None:
    unknown = np.full(ROWS, np.nan)
    seen = COMMAND + EFFECTS @ np.ones(5)
    found = agreement(compare(COMMAND, COMMAND, seen, EVERY), errors(EFFECTS), unknown)
    assert not found.instrument
    assert found.expected_um < drawn(np.random.default_rng(7)).expected_um
    nothing = agreement(compare(COMMAND, COMMAND, seen, EVERY), errors(np.zeros((ROWS, 2, 5))), unknown)
    assert (nothing.expected_um, nothing.share, nothing.probability) == (0.0, 0.0, 0.0)
    assert math.isnan(nothing.within)


def test_rows_that_are_not_compared_have_no_errors() -> None:
    rows = EVERY.copy()
    rows[[3, 7]] = False
    found = agreement(compare(COMMAND, COMMAND, COMMAND + 0.01, rows), errors(EFFECTS[rows]), U_MM)
    assert np.flatnonzero(np.isnan(found.normalised[:, 0])).tolist() == [3, 7]
    assert np.flatnonzero(np.isnan(found.u_mm[:, 1])).tolist() == [3, 7]


def test_positions_in_one_place_have_no_orientation() -> None:
    with pytest.raises(UnidentifiableError, match="all positions lie in one place"):
        rigid_fit(np.full((5, 2), 300.0), COMMAND[:5])
