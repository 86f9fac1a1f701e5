"""Is an identified arm the one that was measured? Bounds, undone mistakes and other starts answer."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.plausibility.bounded_fit import BoundedFit, Case, fitted, offsets
from catseye.calibration.scara.plausibility.bounds import Bounds
from catseye.calibration.scara.plausibility.corrections import Correction, corrections
from catseye.calibration.scara.plausibility.findings import (
    Joint,
    Mistake,
    OtherSolution,
    VagueLink,
    Verdict,
)
from catseye.calibration.scara.plausibility.jumps import jumps
from catseye.calibration.scara.points import FEWEST, without_short_segments

_FAR_BEYOND: Final = 2.0
"""Residuals beyond so many times what was stated lead to corrections being tried; none need explain them."""

_UNSTATED_MM: Final = 0.05
"""Stands for what was stated where nothing was."""

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

_MOST_ROWS: Final = 1500
"""More distances say no more about a mistake."""

_FEW_ROWS: Final = 500
"""More distances say no more about a wrong guess or another solution."""

_FAR_SHIFT: Final = 4.0
"""Starts are shifted by so many times the bound of a place."""

_SAME_MM: Final = 1.0
"""Solutions whose reflectors and links differ by less are one and the same."""

_NO_WORSE: Final = 1.1
"""Another solution whose residuals are up to so many times those of the first is not distinguished from it."""


def case_of(problem: Problem, found: Identification | None) -> Case:
    """Return the case of a problem: the distances that its identification used, all of them where it failed."""
    points = without_short_segments(problem.points)[0] if found is None else found.points
    places = problem.reflectors_mm[[problem.points.reflector_names.index(n) for n in points.reflector_names]]
    nodes = problem.nodes1_rad, problem.nodes2_rad
    return Case(points, nodes, (problem.link1_mm, problem.link2_mm), places).of_points(points)


def judge(
    case: Case, found: Identification | None, bounds: Bounds, stated_mm: float = _UNSTATED_MM
) -> Verdict:
    """Judge an identified arm, or distances from which none could be identified.

    Args:
        case: the distances, and what was known before.
        found: what was identified; None where that failed.
        stated_mm: root mean square of the errors that were stated for the distances.
    """
    off = () if found is None else offsets(found.layout, found.parameters, case, bounds)
    breaks = tuple(one for one in off if one.share > 1.0)
    asis = fitted(case.thinned(_MOST_ROWS), bounds)
    rms_mm = None if asis is None else asis.rms_mm
    beyond = asis is None or asis.strain(bounds) > 1.0
    if asis is None or beyond or asis.rms_mm > _FAR_BEYOND * stated_mm:
        mistakes = _mistakes(case, asis, bounds, broken=beyond or bool(breaks))
        if mistakes or found is None:
            return Verdict(breaks, mistakes, rms_mm=rms_mm)
    elif found is None:
        return Verdict(rms_mm=rms_mm)
    elif breaks:
        # What is known of the arm makes another one of it, and the distances do not mind.
        own_mm = 1e-3 * found.fit.rms_um
        return Verdict(breaks, others=(_other(asis, own_mm),), vague=_vague(found, bounds), rms_mm=rms_mm)
    return Verdict(breaks, (), tuple(_others(case, found, bounds)), _vague(found, bounds), rms_mm)


def _vague(found: Identification, bounds: Bounds) -> tuple[VagueLink, ...]:
    """Return the links that the distances leave open by more than their bound."""
    links: tuple[Joint, ...] = (1, 2)
    u_mm = found.standard_uncertainty[:2].tolist()
    return tuple(
        VagueLink(link, u, bounds.link_mm) for link, u in zip(links, u_mm, strict=True) if u > bounds.link_mm
    )


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


def _mistakes(case: Case, asis: BoundedFit | None, bounds: Bounds, *, broken: bool) -> tuple[Mistake, ...]:
    """Return the simplest mistakes that explain the distances, each alone.

    Args:
        asis: the distances as they are, solved.
        broken: a bound is broken as they are, or they have no solution.
    """
    enough = _FINE_MM if broken else 0.0
    if asis is not None:
        enough = max(enough, _MUCH_BETTER * asis.rms_mm)
    few = case.thinned(_MOST_ROWS)
    near = [fit for fit in (asis, fitted(few.distrusted, bounds)) if fit is not None]
    tried = [*corrections(case), *jumps(few, near)]
    good = [one for one in (_explained(each, bounds, enough) for each in tried) if one is not None]
    if not good:
        return ()
    best = min(one.rms_mm for one in good)
    equal = [one for one in good if one.rms_mm <= _EQUAL * best]
    simplest = min(one.freedom for one in equal)
    simple = [one for one in equal if one.freedom == simplest]
    least = min(one.strain for one in simple)
    return tuple(one.mistake for one in simple if one.strain <= _EQUAL * least + _LITTLE_STRAIN)


def _explained(tried: Correction, bounds: Bounds, enough_mm: float) -> _Explanation | None:
    """Solve a corrected case; first without maps, which tells most wrong guesses."""
    case = tried.case.thinned(_MOST_ROWS)
    if len(case.points) < FEWEST:
        return None
    coarse = fitted(case.thinned(_FEW_ROWS).without_maps, bounds)
    if coarse is None or coarse.rms_mm > _COARSE_MM:
        return None
    fit = fitted(case, bounds, coarse.places_mm)
    if fit is None or fit.rms_mm > enough_mm or (strain := fit.strain(bounds)) > 1.0:
        return None
    return _Explanation(tried.mistake(fit), tried.freedom, fit.rms_mm, strain)


def _others(case: Case, found: Identification, bounds: Bounds) -> Iterator[OtherSolution]:
    """Return further solutions that the distances do not distinguish from the one that was found."""
    like = (case if found.layout.model == "error-map" else case.without_maps).thinned(_FEW_ROWS)
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
            yield _other(fit, own.rms_mm)


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


def _other(fit: BoundedFit, own_mm: float) -> OtherSolution:
    names, places = fit.layout.reflector_names, fit.places_mm.tolist()
    return OtherSolution(
        (float(fit.parameters[0]), float(fit.parameters[1])),
        tuple((name, x, y) for name, (x, y) in zip(names, places, strict=True)),
        fit.rms_mm,
        own_mm,
    )
