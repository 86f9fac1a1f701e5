"""Nested models: does the error map earn its keep, and does anything beyond it?"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.core.projection import Projection, explained_um
from catseye.calibration.core.significance import Judged, adjusted, aicc, bic, f_test
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.diagnostics.projection import projection_of
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.identification import Identification

CONVENTIONAL, ERROR_MAP, TOGETHER = "conventional", "error map", "all together"


@dataclass(frozen=True)
class Extension:
    """Terms that are tried together.

    Attributes:
        name: what they are called.
        terms: the terms.
    """

    name: str
    terms: tuple[Term, ...]


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
        probability: of a ratio this large when it adds nothing, corrected for the extensions tried.
        terms: what it has beyond the maps.
        coefficients: of the terms, rad or mm, shape (k,).
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
    terms: tuple[Term, ...]
    coefficients: Floats
    u: Floats

    @property
    def significant(self) -> bool:
        """The stated errors alone do not look like this."""
        return not self.refused and super().significant


@dataclass(frozen=True)
class _Fitted:
    identified: Identification
    projection: Projection


def compare_models(
    problem: Problem, extensions: Sequence[Extension], progress: Callable[[str], None] = lambda _: None
) -> list[ComparedModel]:
    """Fit the conventional model, the error map, each extension of it, and all that could be identified together.

    Args:
        progress: called with the name of each model when its turn comes.

    Raises:
        CalibrationError: the error map itself cannot be identified.
    """
    progress(ERROR_MAP)
    error_map = _fitted(problem)
    fixed = replace(problem, points=error_map.identified.points, budget=problem.budget)
    progress(CONVENTIONAL)
    conventional = _fitted(replace(fixed, model="conventional"))
    rows = [
        _compared(CONVENTIONAL, None, conventional, 1),
        _compared(ERROR_MAP, (CONVENTIONAL, conventional), error_map, 1),
    ]
    tried = [_tried(fixed, one, error_map, len(extensions), progress) for one in extensions]
    possible = tuple(term for row in tried if not row.refused for term in row.terms)
    if sum(not row.refused for row in tried) > 1:
        tried.append(_tried(fixed, Extension(TOGETHER, possible), error_map, 1, progress))
    return rows + tried


def _fitted(problem: Problem) -> _Fitted:
    identified = problem.solve()
    return _Fitted(identified, projection_of(identified))


def _tried(
    problem: Problem, extension: Extension, base: _Fitted, tests: int, progress: Callable[[str], None]
) -> ComparedModel:
    progress(extension.name)
    try:
        fitted = _fitted(problem.with_terms(extension.terms))
    except CalibrationError as error:
        return _refused(extension, str(error))
    return _compared(extension.name, (ERROR_MAP, base), fitted, tests)


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
        terms=extension.terms,
        coefficients=nothing,
        u=nothing,
    )


def _compared(name: str, base: tuple[str, _Fitted] | None, fitted: _Fitted, tests: int) -> ComparedModel:
    identified, projection = fitted.identified, fitted.projection
    extension = identified.layout.extension
    size = (projection.square, len(identified.points), identified.fit.n_parameters)
    gained_um, ratio, probability = (0.0, np.nan, 1.0) if base is None else _gain(base[1], fitted)
    return ComparedModel(
        name,
        None if base is None else base[0],
        None,
        n_parameters=identified.fit.n_parameters,
        rms_um=identified.fit.rms_um,
        aicc=aicc(*size),
        bic=bic(*size),
        explained_um=gained_um,
        ratio=ratio,
        probability=adjusted(probability, tests),
        terms=identified.layout.terms,
        coefficients=identified.parameters[extension],
        u=identified.standard_uncertainty[extension],
    )


def _gain(base: _Fitted, larger: _Fitted) -> tuple[float, float, float]:
    """Return what a larger model explains, µm, F and its probability."""
    one, other = base.projection, larger.projection
    gain = max(one.square - other.square, 0.0)
    test = f_test(gain, one.dof - other.dof, other.square, other.dof)
    return explained_um(one, test), test.ratio, test.probability
