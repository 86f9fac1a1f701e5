"""How large shared errors are: variances of their components, estimated from the rows with the stated ones as prior.

A budget says how large an error is on the whole, not how it is spread over its harmonics; a generalised least squares
that trusts a wrong spectrum is not honest. The variance of each component (a contributor's harmonic) is therefore
estimated by restricted maximum likelihood, on a logarithmic scale relative to what is stated, with a prior in which
all components, those of one contributor, and each alone may differ from it, and in which all spectra may fall with
the order alike. How far they may is itself averaged over a few scales, weighted by their evidence (Laplace's
approximation). What is returned is the mean variance of each component: it exceeds the likeliest one by what the rows
leave open, so that the uncertainties stay honest.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
from scipy import linalg, optimize, special

from catseye.calibration.core.budget import Shared
from catseye.calibration.core.errors import ConvergenceError
from catseye.calibration.core.least_squares import column_space
from catseye.calibration.core.model import Model
from catseye.calibration.core.residuals import NORMAL_MAD
from catseye.calibration.core.source_sums import beside_others
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.core.whitening import Whitening

_SPREADS = (0.15, 0.5, 1.0, 2.0)
"""How far variances may differ from the stated ones, e-folds: scales of the prior."""

_TOGETHER, _OF_CONTRIBUTOR = 1.5, 0.7
"""How far all components, and those of one contributor, differ together, in units of what each does alone."""

_ALIKE = 2.0
"""How steeply all spectra fall or rise alike, in the same units for each e-fold of the order. Where rows do not show
an order of one axis, its other orders and the other axes then say what to expect."""

_ASSUMED = 2.5
"""How far a variance may differ from one that is merely assumed, e-folds."""

_TRIED = 37
"""Sizes at which such a variance is tried."""

_FLATTEST = 0.3
"""Curvatures of the posterior below this, in units of the prior's, are rounding of Laplace's approximation."""

_LARGEST = 100.0
"""An error ten times as large as stated is another error: rows that ask for more do not fit, and the test of the fit
says so."""

_MOST_ROWS = 40_000
"""So many rows, evenly spread, say how large the components are; further ones cost time."""

_STEEPEST = math.log(1e4)
"""Logarithm of a ratio that ratios approach but do not exceed: no digits are left there, and none are needed."""

_BEND = 4.0
"""How sharply they do: a ratio of 1 is changed by less than 1e-16. A kink would keep the search from settling."""

_FAR = 4.0
"""Residuals beyond so many robust standard deviations count as if they were that: single wrong rows say nothing of a
contributor."""

_MOST_STEPS = 200
"""Ten are usual."""

_SETTLED = 0.01
"""Standard deviations of the posterior that the maximum may be off by."""

_UNSETTLED = (
    "how large the errors are that several rows share cannot be estimated: the search for their likeliest sizes does "
    "not settle. Look at the rows (catseye diagnose), or state the spectrum of the budget's axis-angle contributors "
    "(1 for each order keeps the stated size; a single 1 for what lies between nodes)"
)

_WIDEST = 5.0
"""Variance of a logarithm beyond which the mean of a variance is no longer raised."""


def even_step(rows: int) -> int:
    """Return which of so many rows are asked: each first of so many."""
    return -(-rows // _MOST_ROWS)


@dataclass(frozen=True)
class Compressed:
    """Rows reduced to what they say of shared sources, the parameters eliminated.

    Attributes:
        matrix: FᵀPF of the weighted effects F of m sources, P the projection off the model's columns, shape (m, m).
        vector: FᵀPr of the weighted residuals, shape (m,).
        component: number of each source's component, -1 where its variance is as stated, shape (m,).
        contributor: number of each component's contributor, shape (k,).
        assumed: components whose size nobody knows beforehand, shape (k,).
    """

    matrix: Floats
    vector: Floats
    component: Ints
    contributor: Ints
    assumed: Bools

    @classmethod
    def of(
        cls, model: Model, values: Floats, shared: Sequence[Shared], beside: Floats | None = None
    ) -> "Compressed":
        """Reduce a model's rows, or evenly spread ones of very many, at parameters of shape (p,).

        Args:
            shared: what the rows have in common there.
            beside: further columns that are eliminated with the parameters', mm, shape (n, k).
        """
        every = slice(None, None, even_step(model.weights.size))
        whitening = Whitening.of(model.weights, shared)
        weights, effects = whitening.weights[every], whitening.effects[every]
        jacobian = model.jacobian(values)[every] * weights[:, None]
        # In the order of Fortran, for LAPACK to work in place: there may be a hundred megabytes of it.
        columns = (model.parameters.basis.T @ jacobian.T).T
        del jacobian
        if beside is not None:
            columns = np.hstack([columns, beside[every] * weights[:, None]])
        basis = column_space(columns)
        left = effects - basis @ (basis.T @ effects)
        weighted = model.residuals(values)[every] * weights
        residuals = _winsorised(weighted - basis @ (basis.T @ weighted))
        return cls(left.T @ left, left.T @ residuals, *_numbered(shared))

    @cached_property
    def members(self) -> Floats:
        """Flags of the sources of each component, shape (k, m)."""
        same = np.arange(self.contributor.size)[:, None] == self.component
        return np.asarray(same, dtype=np.float64)

    def variances(self, logarithms: Floats) -> Floats:
        """Return the sources' variances relative to the stated ones, shape (m,)."""
        ratios = np.exp(_levelled(logarithms)[0])[self.component]
        return np.asarray(np.where(self.component >= 0, ratios, 1.0), dtype=np.float64)


def _levelled(logarithms: Floats) -> tuple[Floats, Floats]:
    """Return logarithms that stay below the steepest one, and their derivatives, shape (k,) each."""
    beyond = _BEND * (logarithms - _STEEPEST)
    return logarithms - np.logaddexp(0.0, beyond) / _BEND, np.asarray(special.expit(-beyond))


def _winsorised(weighted: Floats) -> Floats:
    limit = _FAR * float(np.median(np.abs(weighted))) / NORMAL_MAD
    return np.asarray(np.clip(weighted, -limit, limit), dtype=np.float64)


def _numbered(shared: Sequence[Shared]) -> tuple[Ints, Ints, Bools]:
    """Return the number of each source's component, of each component's contributor, and whether it is assumed."""
    component, contributor = [np.zeros(0, dtype=np.int64)], [np.zeros(0, dtype=np.int64)]
    count = 0
    for number, one in enumerate(shared):
        if one.part is None:
            component.append(np.full(one.effects_mm.shape[1], -1))
            continue
        parts = int(one.part.max()) + 1
        component.append(count + one.part)
        contributor.append(np.full(parts, number))
        count += parts
    numbers = np.concatenate(contributor)
    return (
        np.concatenate(component),
        numbers,
        np.array([one.assumed for one in shared], dtype=np.bool_)[numbers],
    )


def variance_ratios(rows: Compressed, *, for_test: bool = False) -> Floats:
    """Return the components' mean variances relative to the stated ones, shape (k,).

    Args:
        for_test: return variances whose reciprocals are right on the average instead: the mean of what is possible
            is on the safe side for an uncertainty, and a test that takes errors too large finds too little. Where the
            rows say nothing, both are as stated.
    """
    if not rows.contributor.size:
        return np.zeros(0)
    fits = [_fitted(rows, spread, for_test=for_test) for spread in _SPREADS]
    evidence = np.array([one.evidence for one in fits])
    share = np.exp(evidence - evidence.max())
    mean = sum(s * one.mean for s, one in zip(share / share.sum(), fits, strict=True))
    return np.asarray(np.where(rows.assumed, mean, np.minimum(mean, _LARGEST)))


def log_evidence(rows: Compressed) -> float:
    """Return the logarithm of how likely rows are, parameters and variances averaged over what the prior allows.

    What does not depend on the shared effects is left out: it compares effects of the same rows.
    """
    if not rows.contributor.size:
        return -restricted_likelihood(rows, np.zeros(0))[0]
    evidence = [_fitted(rows, spread, for_test=False).evidence for spread in _SPREADS]
    return float(special.logsumexp(evidence)) - math.log(len(evidence))


@dataclass(frozen=True)
class _Fitted:
    """Variances at one scale of the prior, shape (k,), and the logarithm of its evidence."""

    mean: Floats
    evidence: float


def _fitted(rows: Compressed, spread: float, *, for_test: bool) -> _Fitted:
    prior = _prior(rows, spread)
    # Rows that say nothing leave the variance as it is stated.
    stated = np.zeros(len(prior)) if for_test else -_raised(np.diag(prior))
    centre = np.where(rows.assumed, -0.5 * _ASSUMED**2, stated)
    root = linalg.cholesky(prior, lower=True)

    @cache
    def posterior(place: bytes) -> tuple[float, Floats, Floats]:
        z = np.frombuffer(place)
        value, slope, second = restricted_likelihood(rows, centre + root @ z)
        return value + 0.5 * float(z @ z), root.T @ slope + z, root.T @ second @ root + np.eye(z.size)

    def objective(z: Floats) -> tuple[float, Floats]:
        return posterior(z.tobytes())[:2]

    def curvature(z: Floats) -> Floats:
        return posterior(z.tobytes())[2]

    start = np.zeros(rows.contributor.size)
    found = optimize.minimize(
        objective, start, (), "trust-exact", jac=True, hess=curvature, options={"maxiter": _MOST_STEPS}
    )
    values, vectors = linalg.eigh(curvature(found.x))
    steep = np.maximum(values, _FLATTEST)
    # Near the maximum rounding may stop the search, and it calls that a failure.
    left = (vectors.T @ objective(found.x)[1]) / np.sqrt(steep)
    if float(left @ left) > _SETTLED**2:
        raise ConvergenceError(_UNSETTLED)
    # What estimates scatter by is what rows say; what they leave open adds to it the uncertainty of each variance.
    shares = np.maximum(steep - 1.0, 0.0) / steep**2 if for_test else 1.0 / steep
    spreads = np.sum((root @ (vectors * np.sqrt(shares))) ** 2, axis=1)
    mean = np.exp(centre + root @ found.x + _raised(spreads))
    for place in np.flatnonzero(rows.assumed):
        mean[place] = _mean_of_assumed(rows, centre + root @ found.x, int(place), float(centre[place]))
    return _Fitted(mean, -float(found.fun) - 0.5 * float(np.sum(np.log(steep))))


def _mean_of_assumed(rows: Compressed, logarithms: Floats, place: int, centre: float) -> float:
    """Return the mean variance of a component with a wide prior, the others held: its logarithm is not normal.

    What rows allow ends on the side of large variances, while small ones are all alike to them.
    """
    tried = centre + _ASSUMED * np.linspace(-3.0, 6.0, _TRIED)
    size, pull = beside_other_components(rows, logarithms, place)
    grown = np.exp(tried)[:, None] * size
    likelihood = 0.5 * np.sum(np.log1p(grown) - np.exp(tried)[:, None] * pull**2 / (1.0 + grown), axis=1)
    values = likelihood + 0.5 * ((tried - centre) / _ASSUMED) ** 2
    weights = np.exp(values.min() - values)
    return float(weights @ np.exp(tried) / weights.sum())


def beside_other_components(rows: Compressed, logarithms: Floats, place: int) -> tuple[Floats, Floats]:
    """Return what rows say of one component's sources beside all others, along its principal directions.

    Returns:
        Eigenvalues of FᵀQF and the parts of FᵀQr along its eigenvectors, Q without the component, shape (k,) each.
    """
    own = rows.component == place
    scale = np.where(own, 1.0, np.sqrt(rows.variances(logarithms)))
    left, pulls, _ = beside_others(scale[:, None] * rows.matrix * scale, scale * rows.vector, own)
    size, directions = linalg.eigh(left)
    return np.maximum(size, 0.0), directions.T @ pulls


def _raised(variance: Floats) -> Floats:
    """Return by how much the logarithm of a mean exceeds the mean of logarithms of a variance."""
    return np.asarray(0.5 * np.minimum(variance, _WIDEST), dtype=np.float64)


def _prior(rows: Compressed, spread: float) -> Floats:
    same, stated = rows.contributor[:, None] == rows.contributor, ~rows.assumed
    falling = _falling(rows.contributor)
    alike = _TOGETHER**2 + _ALIKE**2 * np.outer(falling, falling)
    prior = spread**2 * (alike + _OF_CONTRIBUTOR**2 * same + np.eye(stated.size))
    return np.asarray(prior * np.outer(stated, stated) + np.diag(_ASSUMED**2 * rows.assumed))


def _falling(contributor: Ints) -> Floats:
    """Return minus the logarithms of the components' orders, of mean 0 in each contributor, shape (k,)."""
    first = np.searchsorted(contributor, contributor)
    logarithms = -np.log1p(np.arange(contributor.size) - first)
    means = np.bincount(contributor, logarithms) / np.maximum(np.bincount(contributor), 1)
    return np.asarray(logarithms - means[contributor], dtype=np.float64)


def restricted_likelihood(rows: Compressed, logarithms: Floats) -> tuple[float, Floats, Floats]:
    """Return minus the restricted log likelihood of logarithms of variances, its gradient and its Hessian."""
    half = np.sqrt(rows.variances(logarithms))
    factor = linalg.cho_factor(np.eye(half.size) + half[:, None] * rows.matrix * half, lower=True)
    seen = half * rows.vector
    known = linalg.cho_solve(factor, seen)
    value = float(np.sum(np.log(np.diag(factor[0]))) - 0.5 * seen @ known)
    # FᵀQF and FᵀQr, Q the inverse covariance off the model's columns, times the roots of the variances.
    inner = np.eye(half.size) - linalg.cho_solve(factor, np.eye(half.size))
    members = rows.members
    slope = 0.5 * members @ (np.diag(inner) - known**2)
    pairs = members @ (np.outer(known, known) * inner - 0.5 * inner**2) @ members.T + np.diag(slope)
    grows = _levelled(logarithms)[1]
    bent = np.diag(slope * _BEND * grows * (1.0 - grows))
    return value, slope * grows, pairs * np.outer(grows, grows) - bent
