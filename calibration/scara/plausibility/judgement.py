"""Is an identified arm the one that was measured? Bounds, undone mistakes and other starts answer."""

import math
from typing import Final

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget_effects import shared_errors, shared_rms_mm
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.plausibility.bounded_fit import BoundedFit, fitted, offsets
from catseye.calibration.scara.plausibility.bounds import BOUNDS, Bounds
from catseye.calibration.scara.plausibility.case import MOST_ROWS, Case
from catseye.calibration.scara.plausibility.explanations import mistakes_of
from catseye.calibration.scara.plausibility.findings import Joint, VagueLink, Verdict
from catseye.calibration.scara.plausibility.mounting import mounting_mistake
from catseye.calibration.scara.plausibility.other_solutions import other_solution, other_solutions
from catseye.calibration.scara.points import rows_of_long_segments, without_short_segments

_FAR_BEYOND: Final = 2.0
"""Residuals beyond so many times what was stated lead to corrections being tried; none need explain them."""

_UNSTATED_MM: Final = 0.05
"""Stands for what was stated where nothing was."""


def judge(problem: Problem, found: Identification | None, bounds: Bounds = BOUNDS) -> Verdict:
    """Judge an identified arm, or distances from which none could be identified.

    Args:
        problem: the distances, and what was known before.
        found: what was identified; None where that failed.
    """
    case = _case(problem, found)
    asis = fitted(case.thinned(MOST_ROWS), bounds)
    left_mm = _left_mm(asis, found)
    if found is None:
        mistakes = mistakes_of(case, bounds)
        open_links = () if mistakes or asis is None else _vague(asis.u_links_mm, bounds)
        return Verdict(mistakes=mistakes, vague=open_links, rms_mm=left_mm)
    off = offsets(found.layout, found.parameters, case, bounds)
    breaks, vague = (
        tuple(one for one in off if one.share > 1.0),
        _vague(found.standard_uncertainty[:2], bounds),
    )
    if (turned := mounting_mistake(problem, found)) is not None:
        return Verdict(breaks, (turned,), rms_mm=left_mm)
    sound = asis is not None and asis.strain(bounds) <= 1.0
    if not sound or left_mm > _FAR_BEYOND * _stated_mm(problem, found):
        if mistakes := mistakes_of(case, bounds):
            return Verdict(breaks, mistakes, rms_mm=left_mm)
    elif asis is not None and breaks:
        # What is known of the arm makes another one of it, and the distances do not mind.
        other = other_solution(asis, 1e-3 * found.fit.rms_um)
        return Verdict(breaks, others=(other,), vague=vague, rms_mm=left_mm)
    return Verdict(breaks, (), tuple(other_solutions(case, found, bounds)), vague, left_mm)


def _left_mm(asis: BoundedFit | None, found: Identification | None) -> float:
    """Return the residuals that an error map leaves, rms: of some of the distances, or of all if these are larger."""
    # A mere offset leaves the maps of a sound arm, too.
    whole_mm = 0.0 if found is None or found.layout.model != "error-map" else 1e-3 * found.fit.rms_um
    return math.inf if asis is None else max(asis.rms_mm, whole_mm)


def _case(problem: Problem, found: Identification | None) -> Case:
    """Return the distances that an identification used, all of them where it failed, with what was known before."""
    points = without_short_segments(problem.points)[0] if found is None else found.points
    places = problem.reflectors_mm[[problem.points.reflector_names.index(n) for n in points.reflector_names]]
    nodes = problem.nodes1_rad, problem.nodes2_rad
    rows = np.flatnonzero(rows_of_long_segments(problem.points)) if found is None else found.rows
    links = problem.link1_mm, problem.link2_mm
    return Case(points, nodes, links, places, rows=rows).of_points(points)


def _stated_mm(problem: Problem, found: Identification) -> float:
    """Return the root mean square of the errors that were stated for the distances, whatever they have shown."""
    if found.points.sigma_mm is None:
        return _UNSTATED_MM
    shared = shared_errors(problem.budget, found.model.geometry(found.parameters))
    return math.sqrt(float(np.mean(found.points.sigma_mm**2)) + shared_rms_mm(shared) ** 2)


def _vague(u_mm: Floats, bounds: Bounds) -> tuple[VagueLink, ...]:
    """Return the links that the distances leave open by more than their bound."""
    links: tuple[Joint, ...] = (1, 2)
    return tuple(
        VagueLink(link, u, bounds.link_mm)
        for link, u in zip(links, u_mm.tolist(), strict=True)
        if u > bounds.link_mm
    )
