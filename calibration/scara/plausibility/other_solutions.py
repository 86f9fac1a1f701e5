"""Arms that the distances fit as well, reached from other starts."""

from collections.abc import Iterator
from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.plausibility.bounded_fit import BoundedFit, fitted
from catseye.calibration.scara.plausibility.bounds import Bounds
from catseye.calibration.scara.plausibility.case import FEW_ROWS, Case
from catseye.calibration.scara.plausibility.findings import OtherSolution

_FAR_SHIFT: Final = 4.0
"""Starts are shifted by so many times the bound of a place."""

_SAME_MM: Final = 1.0
"""Solutions whose reflectors and links differ by less are one and the same."""

_NO_WORSE: Final = 1.1
"""Another solution whose residuals are up to so many times those of the first is not distinguished from it."""

_MUCH_BETTER: Final = 0.5
"""One that leaves less than this share of them is believed even beyond the bounds."""


def other_solutions(case: Case, found: Identification, bounds: Bounds) -> Iterator[OtherSolution]:
    """Return further solutions that the distances do not distinguish from the one that was found."""
    like = (case if found.layout.model == "error-map" else case.without_maps).thinned(FEW_ROWS)
    own = fitted(like, bounds, found.parameters[found.layout.reflectors].reshape(-1, 2))
    if own is None:
        return
    seen = [own]
    for start in _starts(case, bounds):
        fit = fitted(like, bounds, start)
        if fit is None or any(_same(fit, other) for other in seen):
            continue
        seen.append(fit)
        plausible = fit.strain(bounds) <= 1.0 and fit.rms_mm <= _NO_WORSE * own.rms_mm
        if plausible or fit.rms_mm < _MUCH_BETTER * own.rms_mm:
            yield other_solution(fit, own.rms_mm)


def _starts(case: Case, bounds: Bounds) -> Iterator[Floats]:
    """Return rough places, mirrored ones, and ones shifted by several times their bound."""
    yield case.places_mm
    for mirror in (np.array([1.0, -1.0]), np.array([-1.0, 1.0])):
        yield case.places_mm * mirror
    for step in (np.array([1.0, 0.0]), np.array([0.0, 1.0])):
        for sign in (1.0, -1.0):
            yield case.places_mm + sign * _FAR_SHIFT * bounds.place_mm * step


def _same(one: BoundedFit, other: BoundedFit) -> bool:
    lengths = np.r_[0:2, one.layout.reflectors]
    return bool(np.abs(one.parameters[lengths] - other.parameters[lengths]).max() < _SAME_MM)


def other_solution(fit: BoundedFit, own_mm: float) -> OtherSolution:
    """Return a fit as a solution beside one whose residuals are known, mm."""
    names, places = fit.layout.reflector_names, fit.places_mm.tolist()
    return OtherSolution(
        (float(fit.parameters[0]), float(fit.parameters[1])),
        tuple((name, x, y) for name, (x, y) in zip(names, places, strict=True)),
        fit.rms_mm,
        own_mm,
    )
