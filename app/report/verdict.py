"""What a metrologist wants to know first, in sentences."""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from catseye.app.analysis.distance_validation import DistanceValidation
from catseye.app.analysis.robust_identifying import robust_text
from catseye.app.analysis.validation import PathValidation
from catseye.app.files.result_json import Fit, LackOfFitPart, MapTable, Result
from catseye.app.report.agreement import LIMIT, normalised_errors
from catseye.app.report.content import MODEL_TITLES, ReportContent, TruthTables
from catseye.app.report.numbers import counted, decimals_for, fixed, probability, signed, three_digits
from catseye.app.report.path_view import path_axis
from catseye.app.report.residual_groups import reference
from catseye.app.report.reversal import reversal_mdeg
from catseye.calibration.core.significance import SIGNIFICANCE

_BETTER = 0.8
"""An error map that leaves more than this share of the conventional model's error has not earned its keep."""


@dataclass(frozen=True)
class Statement:
    """A sentence and how it is meant."""

    kind: Literal["good", "bad", "note"]
    text: str


def verdict(content: ReportContent) -> list[Statement]:
    """Return the statements that stand at the top of the page."""
    best = content.best
    if best is None:
        return [Statement("bad", "Nothing was identified: there is no result to report.")]
    statements = [Statement("note", identified(best)), fit_verdict(best)]
    if best.fit.null_directions:
        named = "; ".join(", ".join(names) for names in best.fit.null_directions)
        statements.append(Statement("bad", f"Not observable, and therefore without numbers: {named}."))
    statements.append(
        _path_verdict(content.validation)
        if content.distances is None
        else _distance_verdict(content.distances)
    )
    if content.truth is not None and best.model == "error-map":
        statements.append(truth_verdict(best, content.truth))
    # Segments that are too short, and single distances.
    left_out = [f"{len(best.fit.rejected)} left out" if best.fit.rejected else ""]
    left_out.append(f"{counted(len(content.events), 'incident')} on the way" if content.events else "")
    if any(left_out):
        statements.append(Statement("note", f"{_joined(left_out)}: see below."))
    return statements


def identified(result: Result) -> str:
    """Return what was identified, in a sentence."""
    l1, l2 = result.link1_mm, result.link2_mm
    names = ", ".join(place.name for place in result.reflectors)
    decimals = decimals_for((l1.u, l2.u))
    text = (
        f"The {MODEL_TITLES[result.model]} was identified from {result.fit.n_points} distances to "
        f"{counted(len(result.reflectors), 'reflector')} ({names}): L1 = {fixed(l1.value, decimals)} mm "
        f"(u = {1e3 * l1.u:.1f} µm), L2 = {fixed(l2.value, decimals)} mm (u = {1e3 * l2.u:.1f} µm)"
    )
    if result.theta20_mdeg is not None:
        return f"{text}, θ20 = {fixed(result.theta20_mdeg.value, 2)} mdeg (u = {result.theta20_mdeg.u:.2f} mdeg)."
    maps = [
        _range(joint, table) for joint, table in ((1, result.theta1_map), (2, result.theta2_map)) if table
    ]
    return "; ".join([text, *maps]) + "."


def _range(joint: int, table: MapTable) -> str:
    values = [*table.positive_mdeg, *table.negative_mdeg]
    reversal = float(np.mean(reversal_mdeg(table)))
    return (
        f"J{joint} deviates by {signed(min(values), 1)} to {signed(max(values), 1)} mdeg with a mean reversal error "
        f"(− minus +) of {signed(reversal, 1)} mdeg"
    )


def fit_verdict(result: Result) -> Statement:
    """Return whether the model explains the distances."""
    fit, name = result.fit, MODEL_TITLES[result.model]
    lack = fit.lack_of_fit
    if lack is not None and lack.significant and not lack.explained:
        return Statement("bad", f"LACK OF FIT: repeats {_misses(name, lack)}; {_widened(fit)}.")
    judged = _against_stated(fit, name)
    if lack is None or not lack.significant:
        return judged
    expected = f"F = {three_digits(lack.expected_ratio)} expected, {probability(lack.probability_stated)}"
    told = f"Repeats {_misses(name, lack)}; the stated systematic contributors account for it ({expected})."
    return Statement(judged.kind, f"{judged.text} {told}")


def _against_stated(fit: Fit, name: str) -> Statement:
    if fit.robust is not None:
        return Statement("note", f"The {name} was identified with {robust_text(fit.robust, fit.n_points)}.")
    if fit.chi2_reduced is None or fit.chi2_probability is None:
        return Statement(
            "note",
            f"No uncertainty was stated for the distances; those of the {name} follow from the scatter of its fit, "
            f"{fit.sigma0_um:.1f} µm a distance.",
        )
    stated = f"the stated {reference(fit).sigma_um:.1f} µm"
    figures = f"χ²/dof = {fit.chi2_reduced:.2f}"
    figures += "" if abs(fit.chi2_expected - 1.0) < 0.005 else f", {fit.chi2_expected:.2f} expected"
    figures += f", {probability(fit.chi2_probability)}"
    if fit.chi2_probability < SIGNIFICANCE:
        text = f"scatters by {fit.sigma0_um:.1f} µm, more than {stated} ({figures}); {_widened(fit)}"
        return Statement("bad", f"The fit of the {name} {text}.")
    if fit.chi2_probability > 1.0 - SIGNIFICANCE:
        text = f"scatters by {fit.sigma0_um:.1f} µm only, less than {stated} ({figures})"
        return Statement("note", f"The fit of the {name} {text}: the stated uncertainty is on the safe side.")
    return Statement("good", f"The fit of the {name} agrees with {stated} ({figures}).")


def _misses(name: str, lack: LackOfFitPart) -> str:
    return (
        f"of a pose scatter by {lack.pure_um:.1f} µm, but the {name} misses them by "
        f"{lack.systematic_um:.1f} µm in a systematic way (F = {three_digits(lack.ratio)}, "
        f"{probability(lack.probability)})"
    )


def _widened(fit: Fit) -> str:
    if fit.chi2_reduced is None:
        return "the uncertainties follow from the fit and include it"
    if fit.variance_factor <= 1.0:
        return "the stated uncertainties are large enough to cover it and were not widened"
    return f"the uncertainties were widened by a factor {math.sqrt(fit.variance_factor):.2f}"


def _path_verdict(validation: PathValidation | None) -> Statement:
    if validation is None:
        return Statement("note", "The prediction has not been checked against an independent instrument.")
    axis = path_axis(validation.path)
    last, first = validation.models[-1], validation.models[0]
    where = f"On the path {axis.title} the {MODEL_TITLES[last.model]} leaves {last.comparison.rms_2d_um:.1f} µm rms"
    rows = f"{int(validation.compared.sum())} of {validation.compared.size} rows compared"
    if validation.ratio is None:
        return Statement("note", f"{where} (2D, {rows}).")
    text = (
        f"{where} (2D), the {MODEL_TITLES[first.model]} {first.comparison.rms_2d_um:.1f} µm: "
        f"ratio {validation.ratio:.2f} ({rows})."
    )
    return Statement("good" if validation.ratio < _BETTER else "bad", text)


def _distance_verdict(distances: DistanceValidation) -> Statement:
    last, first = distances.models[-1], distances.models[0]
    rows = f"{int(distances.compared.sum())} of {distances.compared.size} rows compared"
    where = f"On distances along a path the {MODEL_TITLES[last.model]} leaves {last.rms_um:.1f} µm rms"
    if distances.ratio is None:
        return Statement("note", f"{where} ({rows}).")
    text = f"{where}, the {MODEL_TITLES[first.model]} {first.rms_um:.1f} µm: ratio {distances.ratio:.2f} ({rows})."
    return Statement("good" if distances.ratio < _BETTER else "bad", text)


def truth_verdict(result: Result, truth: TruthTables) -> Statement:
    """Return whether the stated uncertainties cover the distance to the truth."""
    errors = normalised_errors(result, truth)
    if not errors:
        return Statement("note", "No parameter could be compared with the truth.")
    values = np.array([error.value for error in errors])
    within = int(np.sum(np.abs(values) <= LIMIT))
    worst = errors[int(np.argmax(np.abs(values)))]
    share = within / len(errors)
    return Statement(
        "good" if share >= 0.9 else "bad",
        f"Against the truth of the emulated bench {within} of {len(errors)} parameters lie within ±2 u "
        f"({100.0 * share:.0f} %, 95 % expected); rms of the normalised errors {np.sqrt(np.mean(values**2)):.2f}, "
        f"the largest {signed(worst.value, 2)} at {worst.name}.",
    )


def _joined(parts: list[str]) -> str:
    return " and ".join(part for part in parts if part)
