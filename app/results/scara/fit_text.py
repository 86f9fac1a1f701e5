"""What a result is and what its fit is worth, in sentences: the only place that judges a fit in words."""

import math

import numpy as np

from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import (
    EXPANDED,
    OF_UNIT,
    THREE_DIGITS,
    counted,
    decimals_for,
    fixed,
    number,
    probability_text,
)
from catseye.app.results.scara.names import MODEL_TITLES
from catseye.app.results.scara.residuals import reference
from catseye.app.results.scara.result import Fit, LackOfFitPart, MapTable, Result
from catseye.app.results.scara.reversal import reversal_mdeg
from catseye.app.results.scara.robust import robust_text
from catseye.calibration.core.significance import SIGNIFICANCE

_SIGNED = fixed(1, signed=True)


def no_map_text(result: Result) -> str:
    """Return what a model without maps has instead; empty for one with maps."""
    offset = result.theta20_mdeg
    if offset is None:
        return ""
    return f"no map: θ20 = {offset.value:.2f} mdeg, U = {EXPANDED * offset.u:.2f}"


def distances_text(count: int, returns: int | None) -> str:
    """Return how many distances there are, and how many of them are returns to a pose measured before."""
    return f"{count} distances ({returns} of them returns)" if returns else f"{count} distances"


def identified_text(result: Result) -> str:
    """Return what was identified, in a sentence."""
    l1, l2 = result.link1_mm, result.link2_mm
    names = ", ".join(place.name for place in result.reflectors)
    form = fixed(decimals_for((l1.u, l2.u)))
    distances = distances_text(result.fit.n_points, result.fit.n_returns)
    text = (
        f"The {MODEL_TITLES[result.model]} was identified from {distances} to "
        f"{counted(len(result.reflectors), 'reflector')} ({names}): L1 = {number(l1.value, form)} mm "
        f"(U = {EXPANDED * 1e3 * l1.u:.1f} µm), L2 = {number(l2.value, form)} mm "
        f"(U = {EXPANDED * 1e3 * l2.u:.1f} µm, k = 2)"
    )
    if result.theta20_mdeg is not None:
        offset = result.theta20_mdeg
        return f"{text}, θ20 = {number(offset.value, OF_UNIT['mdeg'])} mdeg (U = {EXPANDED * offset.u:.2f} mdeg)."
    maps = [
        _range(joint, table) for joint, table in ((1, result.theta1_map), (2, result.theta2_map)) if table
    ]
    return "; ".join([text, *maps]) + "."


def _range(joint: int, table: MapTable) -> str:
    values = [*table.positive_mdeg, *table.negative_mdeg]
    low, high, reversal = (
        number(value, _SIGNED) for value in (min(values), max(values), float(np.mean(reversal_mdeg(table))))
    )
    return (
        f"J{joint} deviates by {low} to {high} mdeg with a mean reversal error (+ minus −, ISO 230-2) of "
        f"{reversal} mdeg"
    )


_UNTESTED = (
    "Not tested for lack of fit: streamed distances are not searched for repeats, for a joint that moves makes none. "
    "What the model misses at a pose widens no uncertainty here unless χ² shows it; if poses were repeated, identify "
    "a table of at most 100 000 of the distances too."
)


def fit_statements(result: Result) -> list[Statement]:
    """Return whether the arm can be the one measured, whether it explains the distances, what is not observable."""
    statements = _kept_statements(result)
    statements.append(fit_statement(result.fit, MODEL_TITLES[result.model]))
    if result.fit.null_directions:
        named = "; ".join(", ".join(names) for names in result.fit.null_directions)
        statements.append(Statement(Sign.BAD, f"Not observable, and therefore without numbers: {named}."))
    if result.scan is not None and not result.scan.lack_of_fit_tested:
        statements.append(Statement(Sign.NEUTRAL, _UNTESTED))
    return statements


def nodes_only_statements(result: Result) -> list[Statement]:
    """Return that nothing was measured between the nodes of a joint, and what is assumed of it."""
    measured = result.residuals
    if measured is None or result.theta1_map is None or result.theta2_map is None:
        return []
    joints = [
        joint
        for joint, angles, table in (
            ("J1", measured.theta1_deg, result.theta1_map),
            ("J2", measured.theta2_deg, result.theta2_map),
        )
        if set(angles) <= set(table.node_deg)
    ]
    if not joints:
        return []
    stated = [] if result.budget is None else result.budget.contributor
    assumed = [f"{one.stated} of {str(one.axis).upper()}" for one in stated if one.kind == "between-nodes"]
    what = f"is assumed ({', '.join(assumed)} rms, error budget)" if assumed else "is in no uncertainty"
    return [
        Statement(
            Sign.ATTENTION,
            f"Nothing was measured between the nodes of {' and '.join(joints)}: what lies there {what}; open-loop "
            "measures it (off_node).",
        )
    ]


def _kept_statements(result: Result) -> list[Statement]:
    """Return what speaks against an implausible arm, and why it was kept; nothing for any other."""
    kept = result.implausible
    if kept is None:
        return []
    return [
        Statement(Sign.BAD, f"IMPLAUSIBLE: {'; '.join(kept.findings)}."),
        Statement(Sign.BAD, f"It was kept all the same, for this reason: {kept.accepted}"),
    ]


def left_out_statements(result: Result) -> list[Statement]:
    """Return which distances were left out, and why."""
    return [Statement(Sign.NEUTRAL, f"Left out: {text}.") for text in result.fit.rejected]


def fit_statement(fit: Fit, name: str) -> Statement:
    """Return whether a model explains its distances."""
    lack = fit.lack_of_fit
    if lack is not None and lack.significant:
        return Statement(Sign.BAD, f"LACK OF FIT: repeats {_misses(name, lack)}; {_widened(fit)}.")
    return _against_stated(fit, name)


def _against_stated(fit: Fit, name: str) -> Statement:
    if fit.robust is not None:
        text = robust_text(fit.robust, fit.n_points)
        return Statement(Sign.NEUTRAL, f"The {name} was identified with {text}.")
    if fit.chi2_reduced is None or fit.chi2_probability is None:
        return Statement(
            Sign.NEUTRAL,
            f"No uncertainty was stated for the distances; those of the {name} follow from the scatter of its fit, "
            f"{fit.sigma0_um:.1f} µm a distance.",
        )
    stated = f"the stated {reference(fit).sigma_um:.1f} µm"
    figures = f"χ²/dof = {fit.chi2_reduced:.2f}"
    figures += f", {probability_text(fit.chi2_probability)}"
    if fit.chi2_probability < SIGNIFICANCE:
        text = f"scatters by {fit.sigma0_um:.1f} µm, more than {stated} ({figures}); {_widened(fit)}"
        return Statement(Sign.BAD, f"The fit of the {name} {text}.")
    if fit.chi2_probability > 1.0 - SIGNIFICANCE:
        text = f"scatters by only {fit.sigma0_um:.1f} µm, less than {stated} ({figures})"
        safe = "the stated uncertainty is on the safe side"
        return Statement(Sign.NEUTRAL, f"The fit of the {name} {text}: {safe}.")
    return Statement(Sign.GOOD, f"The fit of the {name} agrees with {stated} ({figures}).")


def _misses(name: str, lack: LackOfFitPart) -> str:
    return (
        f"of a pose scatter by {lack.pure_um:.1f} µm, but the {name} misses them by {lack.systematic_um:.1f} µm "
        f"systematically, beyond what is stated (F = {number(lack.ratio, THREE_DIGITS)}, "
        f"{probability_text(lack.probability)})"
    )


def _widened(fit: Fit) -> str:
    if fit.chi2_reduced is None:
        return "the uncertainties follow from the fit and include it"
    if fit.variance_ratio <= 1.0:
        return "the stated uncertainties are large enough to cover it and were not widened"
    return f"the uncertainties were widened by a factor of {math.sqrt(fit.variance_ratio):.2f}"
