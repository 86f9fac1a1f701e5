"""identify: from distances to an arm."""

import math
from dataclasses import dataclass
from pathlib import Path

from catseye.app.analysis.distance_source import DistanceSource, load_distances
from catseye.app.analysis.extension_words import parse_extensions
from catseye.app.analysis.identified_uncertainty import (
    Propagated,
    by_jacobian,
    by_monte_carlo,
    require_draws,
    sentences,
)
from catseye.app.analysis.identifying import (
    are_simulated,
    identified_result,
    problem_of_rows,
    with_what_speaks_against,
)
from catseye.app.analysis.material import with_reference_links
from catseye.app.analysis.robust_identifying import identify_robustly, robust_text
from catseye.app.analysis.scan_identifying import is_scan
from catseye.app.cluster.sharing import sharing
from catseye.app.commands.identify_scan import identified_scan, say_scan, without_maps
from catseye.app.commands.output import emit, emit_json, say, table
from catseye.app.commands.progress import ProgressBar
from catseye.app.errors import UsageError
from catseye.app.files.result_json import Fit, LackOfFitPart, Result, write_result
from catseye.app.store.unverified import taken_as_it_is
from catseye.calibration.core.contributions import Contributions
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.layout import ModelName
from catseye.procedures.bench import Bench


@dataclass(frozen=True)
class IdentifyOptions:
    """How to identify.

    Attributes:
        model: which model.
        uncertainty: "jacobian" or "monte-carlo".
        draws: of a Monte Carlo.
        seed: of its draws.
        loss: how much far-off distances count: "squares", "huber" or "soft-l1".
        reject: distances beyond so many robust standard deviations are left out; None for none.
        extend: terms beyond the model, as the command line names them.
        workers: processes that share the draws; 0 takes one a core.
        dask: address of a scheduler whose machines share them.
        insecure_cluster: the scheduler may be outside of this machine, and the connection without TLS.
        unverified: take sealed runs too whose files were changed; the result says so.
    """

    model: ModelName
    uncertainty: str
    draws: int
    seed: int
    loss: str = "squares"
    reject: float | None = None
    extend: tuple[str, ...] = ()
    workers: int = 1
    dask: str | None = None
    insecure_cluster: bool = False
    unverified: bool = False


def identify_command(
    output: Path,
    run: list[str],
    points: Path | None,
    cell: Path | None,
    options: IdentifyOptions,
    runs: Path | None,
    as_json: bool,
) -> None:
    """Identify and write the result."""
    if options.uncertainty == "monte-carlo":
        require_draws(options.draws)
    _require_consistent(options)
    if points is not None and cell is not None and not run and is_scan(points):
        result, bench = identified_scan(points, cell, options)
        summary = summary_table(without_maps(result), bench)
        _hand_over(result, summary, output, verdicts(result), as_json=as_json)
        say_scan(result)
        return
    source = load_distances(run, points, cell, runs, options.unverified)
    for text in source.warnings:
        say(text)
    with taken_as_it_is(*source.readers):
        result, texts = _identified(source, options)
    _hand_over(result, summary_table(result, source.bench), output, texts, as_json=as_json)


def _identified(source: DistanceSource, options: IdentifyOptions) -> tuple[Result, list[str]]:
    """Return the result and what is to be said about it."""
    bench, terms = source.bench, parse_extensions(options.extend)
    problem = problem_of_rows(source.rows, bench, options.model, source.budget, terms)
    propagated = _propagated(*identify_robustly(problem, options.loss, options.reject), options)
    result = with_reference_links(
        identified_result(propagated.identified, bench, source.names, are_simulated(source.readers)),
        source.readers,
    )
    result = with_what_speaks_against(result, source.readers).model_copy(
        update={"uncertainty": propagated.part}
    )
    return result, [*verdicts(result), *sentences(propagated.part)]


def _hand_over(result: Result, summary: str, output: Path, texts: list[str], *, as_json: bool) -> None:
    """Write a result and show it."""
    write_result(result, output)
    if as_json:
        emit_json(
            {
                "result": str(output),
                **result.model_dump(include={"model", "gauge", "link1_mm", "link2_mm", "extension", "fit"}),
            }
        )
    else:
        emit(summary)
    for text in texts:
        say(text)
    say(f"{output} written")


def _require_consistent(options: IdentifyOptions) -> None:
    if options.loss != "squares" and options.uncertainty == "monte-carlo":
        raise UsageError(
            f"--loss {options.loss} takes its uncertainties from the scatter of the distances; Monte Carlo draws are "
            "identified by least squares: use --reject K with --uncertainty monte-carlo, or --uncertainty jacobian"
        )


def _propagated(
    identified: Identification, found: Contributions | None, options: IdentifyOptions
) -> Propagated:
    if options.uncertainty == "jacobian":
        return by_jacobian(identified, found)
    bar = ProgressBar("Monte Carlo")
    with sharing(options.workers, options.dask, insecure=options.insecure_cluster) as share:
        try:
            return by_monte_carlo(
                identified,
                options.draws,
                options.seed,
                share,
                lambda done: bar.update(done, options.draws, f"{done} of {options.draws} draws"),
            )
        finally:
            bar.close()


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
