"""An identified arm, as a table and sentences."""

import math

from catseye.app.analysis.robust_identifying import robust_text
from catseye.app.cli.output import say, table
from catseye.app.files.result_json import Fit, LackOfFitPart, Result
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.scara.extension import Term
from catseye.procedures.kit.bench import Bench


def summary_table(result: Result, bench: Bench) -> str:
    """Return links, offset or maps with their standard uncertainties as a table."""
    rows = [
        ["L1", "mm", f"{bench.arm.link1_mm:.3f}", f"{result.link1_mm.value:.4f}", f"{result.link1_mm.u:.4f}"],
        ["L2", "mm", f"{bench.arm.link2_mm:.3f}", f"{result.link2_mm.value:.4f}", f"{result.link2_mm.u:.4f}"],
    ]
    for name, link in (("L1 at 20 °C", result.link1_20c_mm), ("L2 at 20 °C", result.link2_20c_mm)):
        if link is not None:
            rows.append([name, "mm", "", f"{link.value:.4f}", f"{link.u:.4f}"])
    if result.theta20_mdeg is not None:
        rows.append(["θ20", "mdeg", "0", f"{result.theta20_mdeg.value:.2f}", f"{result.theta20_mdeg.u:.2f}"])
    for name, part in (("Δθ1", result.theta1_map), ("Δθ2", result.theta2_map)):
        if part is None:
            continue
        for sign, values, us in (
            ("+", part.positive_mdeg, part.u_positive_mdeg),
            ("−", part.negative_mdeg, part.u_negative_mdeg),
        ):
            rows += [
                [f"{name}({node:g}°, {sign})", "mdeg", "0", f"{value:.2f}", f"{u:.2f}"]
                for node, value, u in zip(part.node_deg, values, us, strict=True)
            ]
    for term in result.extension or []:
        unit = "mdeg" if term.unit == "mdeg" else "µm"
        name = Term(term.target, term.source, term.part, term.order).name
        rows.append([name, unit, "0", f"{term.value:.2f}", f"{term.u:.2f}"])
    return table(["parameter", "unit", "nominal", "identified", "u (k=1)"], rows)


def verdicts(result: Result) -> list[str]:
    """Return plain sentences about the fit."""
    fit = result.fit
    texts = [
        f"{fit.n_points} distances, {fit.n_parameters} free parameters, residuals {fit.rms_um:.2f} µm rms, "
        f"gauge: {result.gauge}"
    ]
    if fit.chi2_reduced is not None and fit.chi2_probability is not None:
        agrees = "agrees with" if fit.chi2_probability >= SIGNIFICANCE else "exceeds"
        texts.append(
            f"scatter {agrees} what the stated uncertainties let expect: χ²/dof = {fit.chi2_reduced:.3f}, "
            f"expected {fit.chi2_expected:.3f}"
        )
    if fit.lack_of_fit is not None and fit.lack_of_fit.significant:
        texts.append(_lack_of_fit(fit, fit.lack_of_fit))
    if fit.robust is not None:
        texts.append(robust_text(fit.robust, fit.n_points))
    return texts + [f"rejected: {text}" for text in fit.rejected]


def _lack_of_fit(fit: Fit, lack: LackOfFitPart) -> str:
    """Return what the repeats say; only what nothing stated explains speaks against the fit."""
    seen = (
        f"repeats of a pose scatter by {lack.pure_um:.1f} µm, the model misses poses by {lack.systematic_um:.1f} µm "
        f"systematically (F = {lack.ratio:.2f})"
    )
    if lack.explained:
        return (
            f"no lack of fit beyond what is stated: {seen}; the stated systematic contributors, which the "
            f"uncertainties contain, let expect F = {lack.expected_ratio:.2f}"
        )
    return f"LACK OF FIT: {seen}; nothing stated explains it; {_widened(fit)}"


def _widened(fit: Fit) -> str:
    if fit.chi2_reduced is None:
        return "the uncertainties follow from the fit and include it"
    if fit.variance_factor <= 1.0:
        return "the stated uncertainties are large enough to cover it and were not widened"
    return f"the uncertainties were widened {math.sqrt(fit.variance_factor):.2f} times"


def without_maps(result: Result) -> Result:
    """Return a result whose summary is short: maps with nodes every degree are for files and pictures."""
    return result.model_copy(update={"theta1_map": None, "theta2_map": None})


def say_scan(result: Result) -> None:
    """Say what is kept of the residuals, and which segments stand out."""
    scan = result.scan
    if scan is None:
        return
    say(f"streamed: {scan.n_sample} of {scan.n_points} residuals kept one by one, all of them by segment")
    segments = scan.segments
    worst = max(range(len(segments.rms_um)), key=lambda i: segments.rms_um[i])
    say(
        f"largest rms of a segment: {segments.rms_um[worst]:.2f} µm, {segments.reflector[worst]}/"
        f"{segments.segment[worst]}; largest residual {max(segments.largest_um):.2f} µm"
    )
