"""Which mistakes explain distances: each is undone, and what the distances then leave is compared."""

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Final

from catseye.calibration.scara.plausibility.bounded_fit import BoundedFit, fitted
from catseye.calibration.scara.plausibility.bounds import Bounds
from catseye.calibration.scara.plausibility.case import FEW_ROWS, MANY_ROWS, MOST_ROWS, Case
from catseye.calibration.scara.plausibility.corrections import Correction, corrections
from catseye.calibration.scara.plausibility.findings import Mistake
from catseye.calibration.scara.plausibility.jumps import jumps
from catseye.calibration.scara.points import FEWEST

_MUCH_BETTER: Final = 0.5
"""A mistake that no bound shows is believed when undoing it leaves less than this share of the residuals."""

_FINE_MM: Final = 0.1
"""Where a bound is broken, an explanation may leave so much, whatever the distances left as they are."""

_COARSE_MM: Final = 5.0
"""Without maps the right correction leaves less: what deviations within their bound do to distances."""

_EQUAL: Final = 2.0
"""Explanations that leave up to so many times what the best one leaves are as good."""

_LITTLE_STRAIN: Final = 0.05
"""A share of a bound that does not speak against an explanation."""


@dataclass(frozen=True)
class _Explanation:
    """A mistake whose correction leaves little.

    Attributes:
        mistake: what was done wrong.
        freedom: how many numbers its correction takes from the distances.
        rms_mm: of the residuals that are left.
        strain: the largest share of a bound that is used up then.
    """

    mistake: Mistake
    freedom: int
    rms_mm: float
    strain: float


def mistakes_of(case: Case, bounds: Bounds) -> tuple[Mistake, ...]:
    """Return the simplest mistakes that explain distances, each alone."""
    some = _explanations(case.thinned(MOST_ROWS), corrections(case), bounds)
    many = case.thinned(MANY_ROWS)
    good = [*some, *_explanations(many, jumps(many, _near(many, bounds), bounds), bounds)]
    if not good:
        return ()
    best = min(one.rms_mm for one in good)
    equal = [one for one in good if one.rms_mm <= _EQUAL * best]
    simplest = min(one.freedom for one in equal)
    simple = [one for one in equal if one.freedom == simplest]
    least = min(one.strain for one in simple)
    return tuple(one.mistake for one in simple if one.strain <= _EQUAL * least + _LITTLE_STRAIN)


def _near(case: Case, bounds: Bounds) -> list[BoundedFit]:
    """Return the arm that distances make, and one that stays near what was known of it."""
    return [fit for fit in (fitted(case, bounds), fitted(case.distrusted, bounds)) if fit is not None]


def _explanations(case: Case, tried: Iterable[Correction], bounds: Bounds) -> Iterator[_Explanation]:
    """Solve corrected cases; yield those that leave little of what the distances leave as they are."""
    asis = fitted(case, bounds)
    broken = asis is None or asis.strain(bounds) > 1.0
    enough = max(_FINE_MM if broken else 0.0, 0.0 if asis is None else _MUCH_BETTER * asis.rms_mm)
    for one in tried:
        thinned = replace(one, case=one.case.thinned(len(case.points)))
        if (explanation := _explained(thinned, bounds, enough)) is not None:
            yield explanation


def _explained(tried: Correction, bounds: Bounds, enough_mm: float) -> _Explanation | None:
    """Solve a corrected case; first without maps, which rules out most wrong guesses."""
    case = tried.case
    if len(case.points) < FEWEST:
        return None
    coarse = fitted(case.thinned(FEW_ROWS).without_maps, bounds)
    if coarse is None or coarse.rms_mm > _COARSE_MM:
        return None
    fit = fitted(case, bounds, coarse.places_mm)
    if fit is None or fit.rms_mm > enough_mm or (strain := fit.strain(bounds)) > 1.0:
        return None
    return _Explanation(tried.mistake(fit), tried.freedom, fit.rms_mm, strain)
