"""A model that is no arm: a straight line through rows, with GTC as oracle of its uncertainties."""

from dataclasses import dataclass, field, replace

import GTC
import numpy as np
import pytest

from catseye.calibration.core.budget import Shared, White, per_group
from catseye.calibration.core.contributions import row_errors, taken_apart
from catseye.calibration.core.cross_validation import Folds, predicted_residuals
from catseye.calibration.core.errors import ConvergenceError, UnidentifiableError
from catseye.calibration.core.estimation import Estimate, estimate
from catseye.calibration.core.least_squares import minimise
from catseye.calibration.core.model import Model, Parameters
from catseye.calibration.core.projection import addition, project
from catseye.calibration.core.repeats import Repeats
from catseye.calibration.core.robust import robust_estimate
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening

PLACES = np.repeat(np.arange(12.0), 2)
TRUE = np.array([3.0, -0.5])
SIGMA = np.linspace(0.01, 0.03, PLACES.size)


@dataclass(frozen=True)
class Line:
    """Rows offset + slope · place; two offsets whose sum alone counts have their difference as gauge."""

    measured: Floats
    places: Floats = field(default_factory=PLACES.copy)
    effects: Floats | None = None
    gauge: bool = False

    @property
    def parameters(self) -> Parameters:
        if not self.gauge:
            return Parameters(("offset", "slope"), ("mm", "1"), np.eye(2))
        basis = np.array([[0.5**0.5, 0.0], [0.5**0.5, 0.0], [0.0, 1.0]])
        return Parameters(("first offset", "second offset", "slope"), ("mm", "mm", "1"), basis)

    @property
    def weights(self) -> Floats:
        return 1.0 / SIGMA

    @property
    def stated(self) -> bool:
        return True

    @property
    def repeats(self) -> Repeats:
        return Repeats.of_numbers(np.asarray(np.unique(self.places, return_inverse=True)[1], dtype=np.int64))

    @property
    def columns(self) -> Floats:
        offsets = np.ones((self.places.size, 2 if self.gauge else 1))
        return np.column_stack([offsets, self.places]).astype(np.float64)

    def residuals(self, values: Floats) -> Floats:
        return np.asarray(self.columns @ values - self.measured)

    def jacobian(self, values: Floats) -> Floats:
        return np.asarray(self.columns + 0.0 * values[0], dtype=np.float64)

    def white(self, values: Floats) -> tuple[White, ...]:
        return (White("reading", SIGMA + 0.0 * values[0], dof=7.0),)

    def shared(self, values: Floats) -> tuple[Shared, ...]:
        effects = self.effects
        return () if effects is None else (Shared("half", effects + 0.0 * values[0], dof=4.0),)


def line(seed: int = 1, *, shared: bool = True) -> Line:
    rng = np.random.default_rng(seed)
    effects = per_group(np.full((PLACES.size, 1), 0.02), (PLACES > 5.0).astype(np.int64))
    noise = rng.standard_normal(PLACES.size) * SIGMA
    if shared:
        noise = noise + effects @ rng.standard_normal(2)
    return Line(TRUE[0] + TRUE[1] * PLACES + noise, effects=effects if shared else None)


def solved(model: Model, size: int = 2) -> Estimate:
    return estimate(model, np.zeros(size))


def covariance_of(model: Line) -> Floats:
    """Return the rows' whole covariance, mm²."""
    effects = np.zeros((PLACES.size, 0)) if model.effects is None else model.effects
    return np.asarray(np.diag(SIGMA**2) + effects @ effects.T, dtype=np.float64)


def fitted(columns: Floats, measured: Floats, covariance: Floats) -> Floats:
    """Return what generalised least squares finds by dense linear algebra."""
    inverse = np.linalg.inv(covariance)
    return np.asarray(
        np.linalg.solve(columns.T @ inverse @ columns, columns.T @ inverse @ measured), dtype=np.float64
    )


def test_covariance_and_degrees_of_freedom_are_those_of_gtc() -> None:
    model = line()
    found = solved(model)
    assert model.effects is not None
    assert found.fit.variance_ratio == 1.0
    sources = [GTC.ureal(0.0, 1.0, 4) for _ in range(2)]
    rows = [
        y + s * white + sum(e * source for e, source in zip(effect, sources, strict=True))
        for y, s, effect, white in zip(
            model.measured, SIGMA, model.effects, [GTC.ureal(0.0, 1.0) for _ in SIGMA], strict=True
        )
    ]
    inverse = np.linalg.inv(covariance_of(model))
    gain = np.linalg.solve(model.columns.T @ inverse @ model.columns, model.columns.T @ inverse)
    values = [sum(g * row for g, row in zip(line_of, rows, strict=True)) for line_of in gain]
    assert found.values == pytest.approx([one.x for one in values])
    expected = [[GTC.get_covariance(a, b) for b in values] for a in values]
    assert found.covariance == pytest.approx(np.array(expected), rel=1e-9)


def test_parts_sum_to_the_covariance() -> None:
    model = line()
    found = solved(model)
    parts = taken_apart(model, found.values, row_errors(model, found.values, found.fit))
    assert parts.names == ("reading", "half")
    assert parts.covariance == pytest.approx(found.covariance, rel=1e-9)


def test_null_directions_carry_their_names() -> None:
    model = line()
    with pytest.raises(UnidentifiableError, match="offset, slope") as caught:
        solved(replace(model, places=np.full(PLACES.size, 4.0)))
    assert caught.value.null_directions == [["offset", "slope"]]


def test_the_gauge_stays_out_of_the_null_directions() -> None:
    plain = line()
    found = solved(replace(plain, gauge=True), 3)
    assert found.values[0] == pytest.approx(found.values[1])
    assert found.values[0] + found.values[1] == pytest.approx(solved(plain).values[0])


def test_an_unsettled_iteration_gives_the_models_advice() -> None:
    with pytest.raises(ConvergenceError, match="look at the clock"):
        minimise(
            lambda x: 1e20 * np.exp(-x),
            lambda x: -1e20 * np.exp(-x)[:, None],
            np.zeros(1),
            np.eye(1),
            Whitening.of(np.ones(1)),
            "look at the clock",
        )


def test_repeats_test_the_lack_of_fit() -> None:
    model = line(shared=False)
    bent = replace(model, measured=model.measured + 0.05 * (PLACES - 5.5) ** 2 / 30.0)
    straight, lacking = solved(model).fit.lack_of_fit, solved(bent).fit.lack_of_fit
    assert straight is not None
    assert not straight.significant
    assert lacking is not None
    assert lacking.significant


@pytest.mark.parametrize("shared", [False, True])
def test_added_function_has_the_coefficient_of_a_full_fit(shared: bool) -> None:
    model = line(shared=shared)
    found = solved(model)
    column = PLACES[:, None] ** 2
    more = addition(project(model, found.values, found.residuals_mm), column)
    assert more is not None
    whole = np.column_stack([model.columns, column])
    expected = fitted(whole, model.measured, covariance_of(model))
    assert more.coefficients[0] == pytest.approx(expected[2])


@pytest.mark.parametrize("shared", [False, True])
def test_left_out_groups_are_predicted_as_by_refitting(shared: bool) -> None:
    model = line(shared=shared)
    found = solved(model)
    groups = (PLACES // 3).astype(np.int64)
    folds = Folds("group", ("a", "b", "c", "d"), groups, np.zeros(4, dtype=np.int64))
    predicted = predicted_residuals(project(model, found.values, found.residuals_mm), folds)
    kept, covariance = groups != 2, covariance_of(model)
    within, across = covariance[np.ix_(kept, kept)], covariance[np.ix_(~kept, kept)]
    rest = fitted(model.columns[kept], model.measured[kept], within)
    left = model.columns @ rest - model.measured
    # What the others' residuals say of the errors that both share is part of the prediction.
    expected = left[~kept] - across @ np.linalg.solve(within, left[kept])
    assert predicted[~kept] == pytest.approx(expected)


@pytest.mark.parametrize("shared", [False, True])
def test_single_wrong_rows_hardly_move_a_robust_estimate(shared: bool) -> None:
    model = line(shared=shared)
    wrong = replace(model, measured=model.measured + np.where(np.arange(PLACES.size) == 20, 5.0, 0.0))
    found = robust_estimate(wrong, solved(wrong), "huber")
    assert found.weights[20] < 0.01
    sound = np.arange(PLACES.size) != 20
    covariance = covariance_of(model)[np.ix_(sound, sound)]
    without = fitted(model.columns[sound], model.measured[sound], covariance)
    assert np.abs(found.estimate.values - without).max() < 0.02
    assert np.abs(solved(wrong).values - without).max() > 0.05
