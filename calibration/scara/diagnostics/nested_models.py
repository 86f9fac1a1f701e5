"""Nested models: does the error map earn its keep, and does anything beyond it?

All models are judged by one covariance. How large the harmonics of its shared errors are is estimated beside
everything that is tried, so that nothing feeds the covariance that it is tested against.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.errors import UnidentifiableError
from catseye.calibration.core.least_squares import minimise
from catseye.calibration.core.model import whitening_at
from catseye.calibration.core.projection import (
    Addition,
    Projection,
    addition,
    explained_um,
    off_columns,
)
from catseye.calibration.core.rank import require_identifiable
from catseye.calibration.core.significance import SIGNIFICANCE, FTest, Judged, adjusted, aicc, bic, f_test
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.diagnostics.thinning import thinned
from catseye.calibration.scara.distance_model import DistanceModel, distance_model
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.identification import Identification, require_separable, with_spectra
from catseye.calibration.scara.pointing import beam_turn_rad

CONVENTIONAL, ERROR_MAP, TOGETHER = "conventional", "error map", "all together"


@dataclass(frozen=True)
class Extension:
    """Terms that are tried together.

    Attributes:
        name: what they are called.
        terms: the terms.
        chosen_from: how many choices there were; the distances themselves proposed this one.
    """

    name: str
    terms: tuple[Term, ...]
    chosen_from: float = 1.0


@dataclass(frozen=True)
class ComparedModel(Judged):
    """One model beside the one that it extends.

    Attributes:
        name: what it is called.
        base: the model that it extends; None for the smallest.
        refused: why it could not be identified; None when it was.
        n_parameters: its free parameters.
        rms_um: rms of its residuals, µm.
        aicc: information criterion.
        bic: information criterion.
        explained_um: standard deviation of a distance that it explains beyond its base, µm; scatter taken off.
        ratio: F.
        probability: of a ratio this large when there is nothing but the stated errors, corrected for the extensions
            tried.
        alone: the same of what an identification with the terms finds; smaller where they are there, but no larger
            than errors that are stated of the same kind.
        terms: what it has beyond the maps.
        coefficients: of the terms, rad or mm, shape (k,), as an identification with them finds.
        u: their standard uncertainties, shape (k,).
    """

    name: str
    base: str | None
    refused: str | None
    n_parameters: int
    rms_um: float
    aicc: float
    bic: float
    explained_um: float
    ratio: float
    probability: float
    alone: float
    terms: tuple[Term, ...]
    coefficients: Floats
    u: Floats

    @property
    def significant(self) -> bool:
        """The stated errors alone do not look like this."""
        return not self.refused and super().significant

    @property
    def as_stated(self) -> bool:
        """It is there, and no larger than the stated errors make it."""
        return not self.refused and not self.significant and self.alone < SIGNIFICANCE


@dataclass(frozen=True)
class _Base:
    """The error map under the covariance that all models share.

    Attributes:
        problem: that it solves.
        identified: the error map.
        model: of its distances; the budget is the one that counts here.
        projection: the fit.
    """

    problem: Problem
    identified: Identification
    model: DistanceModel
    projection: Projection

    @classmethod
    def of(cls, problem: Problem, identified: Identification, tried: Sequence[Extension]) -> "_Base":
        """Ask the distances for the sizes of harmonics beside all terms that are tried."""
        model, budget = identified.model, problem.asked
        if budget is not None:
            every = Extension(TOGETHER, tuple(term for one in tried for term in one.terms))
            larger, values = _extended(problem, identified, every)
            model = replace(
                model, budget=with_spectra(budget, replace(larger, budget=budget), values, for_test=True)
            )
        whitening = whitening_at(model, identified.parameters)
        return cls(problem, identified, model, _fitted(model, identified.parameters, whitening))


def compare_models(
    problem: Problem,
    extensions: Sequence[Extension],
    progress: Callable[[str], None] = lambda _: None,
    identified: Identification | None = None,
) -> list[ComparedModel]:
    """Compare the conventional model, the error map, each extension of it, and all of them together.

    Args:
        progress: called with the name of each model when its turn comes.
        identified: what the problem's solution is, where it is known.

    Raises:
        CalibrationError: the error map itself cannot be identified.
    """
    progress(ERROR_MAP)
    found = problem.solve() if identified is None else identified
    new = [_without_known(one, problem.terms) for one in extensions]
    few = thinned(found)
    refused = {one.name: text for one in new if (text := _why_not(problem, few, one))}
    possible = [one for one in new if one.name not in refused]
    base = _Base.of(problem, found, possible)
    progress(CONVENTIONAL)
    rows = [*_without_terms(base)]
    for one in new:
        progress(one.name)
        text = refused.get(one.name)
        rows.append(_refused(one, text) if text else _with_terms(base, one, len(new)))
    every = Extension(TOGETHER, tuple(dict.fromkeys(term for one in possible for term in one.terms)))
    if len(possible) > 1 and not _why_not(problem, few, every):
        rows.append(_with_terms(base, every, 1))
    return rows


def _without_known(extension: Extension, terms: tuple[Term, ...]) -> Extension:
    return replace(extension, terms=tuple(term for term in extension.terms if term not in terms))


def _extended(
    problem: Problem, identified: Identification, extension: Extension
) -> tuple[DistanceModel, Floats]:
    """Return the model of the distances with further terms, and its parameters where these are zero."""
    layout, points = identified.layout, identified.points
    nominal = problem.link1_mm, problem.link2_mm
    points = replace(points, theta4_rad=beam_turn_rad(points, nominal, problem.rough_places(points)))
    first, rest = np.split(identified.parameters, [layout.extension.stop])
    values = np.concatenate([first, np.zeros(len(extension.terms)), rest])
    larger = replace(layout, terms=(*layout.terms, *extension.terms))
    return distance_model(larger, points, identified.budget), values


def _why_not(problem: Problem, identified: Identification, extension: Extension) -> str | None:
    """Return what the distances lack to determine terms; None where they do."""
    model, values = _extended(problem, identified, extension)
    rough = problem.rough_places(identified.points)
    try:
        require_separable(model, model.start(problem.link1_mm, problem.link2_mm, rough))
        require_identifiable(model.parameters, model.jacobian(values) * model.weights[:, None])
    except UnidentifiableError as error:
        return str(error)
    return None


def _refused(extension: Extension, text: str) -> ComparedModel:
    nothing = np.full(len(extension.terms), np.nan)
    return ComparedModel(
        extension.name,
        ERROR_MAP,
        text,
        n_parameters=0,
        rms_um=np.nan,
        aicc=np.inf,
        bic=np.inf,
        explained_um=0.0,
        ratio=np.nan,
        probability=1.0,
        alone=1.0,
        terms=extension.terms,
        coefficients=nothing,
        u=nothing,
    )


def _fitted(model: DistanceModel, start: Floats, whitening: Whitening) -> Projection:
    """Return the fit of a model whose errors have another's covariance."""
    basis = model.parameters.basis
    solution = minimise(model.residuals, model.jacobian, start, basis, whitening, model.parameters.unsettled)
    return off_columns(whitening, solution.free, solution.residuals)


def _without_terms(base: _Base) -> tuple[ComparedModel, ComparedModel]:
    """Return the conventional model and the error map."""
    problem, points, large = base.problem, base.identified.points, base.projection
    layout = replace(
        base.identified.layout, model="conventional", nodes1_rad=np.zeros(0), nodes2_rad=np.zeros(0)
    )
    model = distance_model(layout, points)
    start = model.start(problem.link1_mm, problem.link2_mm, problem.rough_places(points))
    small = _fitted(model, start, large.whitening)
    gain = _gain(small, large)
    return (
        _row(CONVENTIONAL, None, small, (0.0, np.nan, 1.0)),
        _row(ERROR_MAP, CONVENTIONAL, large, (explained_um(small, gain), gain.ratio, gain.probability)),
    )


def _gain(small: Projection, large: Projection) -> FTest:
    return f_test(max(small.square - large.square, 0.0), small.dof - large.dof, large.square, large.dof)


def _row(
    name: str, base: str | None, projection: Projection, judged: tuple[float, float, float]
) -> ComparedModel:
    rows = projection.residuals.size
    size, (explained, ratio, probability) = (projection.square, rows, rows - projection.dof), judged
    return ComparedModel(
        name,
        base,
        None,
        n_parameters=rows - projection.dof,
        rms_um=projection.rms_um,
        aicc=aicc(*size),
        bic=bic(*size),
        explained_um=explained,
        ratio=ratio,
        probability=probability,
        alone=probability,
        terms=(),
        coefficients=np.zeros(0),
        u=np.zeros(0),
    )


def _with_terms(base: _Base, extension: Extension, tests: int) -> ComparedModel:
    larger, values = _extended(base.problem, base.identified, extension)
    projection = _fitted(larger, values, base.projection.whitening)
    gain, alone = _gain(base.projection, projection), _identified(base, extension)
    if alone is None:
        return _refused(extension, "no distance is left over that would judge it")
    counted = tests * extension.chosen_from
    explained = explained_um(base.projection, gain)
    row = _row(
        extension.name, ERROR_MAP, projection, (explained, gain.ratio, adjusted(gain.probability, counted))
    )
    return replace(
        row,
        alone=adjusted(alone.probability, counted),
        terms=extension.terms,
        coefficients=alone.coefficients,
        u=np.sqrt(np.diag(alone.covariance)),
    )


def _identified(base: _Base, extension: Extension) -> Addition | None:
    """Return what an identification with terms finds: of what they describe, no error is stated any more."""
    larger, values = _extended(base.problem, base.identified, extension)
    stop, jacobian = larger.layout.extension.stop, larger.jacobian(values)
    own = slice(stop - len(extension.terms), stop)
    if not any(term.source == "theta4" for term in extension.terms):
        return addition(base.projection, jacobian[:, own])
    whitening = whitening_at(replace(larger, budget=base.model.budget), values)
    fixed = whitening.rows(np.delete(jacobian, own, axis=1) @ base.model.layout.gauge_basis())
    fit = off_columns(whitening, fixed, base.identified.residuals_mm).settled
    return addition(fit, jacobian[:, own])
