"""What an identification says at its end."""

from catseye.app.results.model import Report, Sign, Statement, section
from catseye.app.results.scara.budget_text import budget_statements
from catseye.app.results.scara.drift_text import drift_statements
from catseye.app.results.scara.fit_text import (
    distances_text,
    fit_statements,
    left_out_statements,
    nodes_only_statements,
)
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.separated_text import separated_statements
from catseye.app.results.scara.uncertainty import uncertainty_statements
from catseye.app.results.scara.values import KINDS, parameter_table


def identification_report(result: Result) -> Report:
    """Return the parameters, how they fit, and where their uncertainties come from."""
    fit = result.fit
    size = (
        f"{distances_text(fit.n_points, fit.n_returns)}, {fit.n_parameters} free parameters, "
        f"residuals {fit.rms_um:.2f} µm rms, gauge: {result.gauge}."
    )
    statements = [Statement(Sign.NEUTRAL, size), *fit_statements(result), *left_out_statements(result)]
    statements += [*separated_statements(result), *drift_statements(result), *nodes_only_statements(result)]
    if result.budget is not None:
        statements += budget_statements(result.budget)
    if result.uncertainty is not None:
        statements += uncertainty_statements(result.uncertainty)
    return Report(
        "Identification",
        result.provenance.origin,
        (
            section("verdict", "Verdict", [*statements, *_scan_statements(result)], brief=True),
            section(
                "parameters",
                "Identified arm",
                # Streamed distances have thousands of dead paths.
                [parameter_table(result, KINDS if result.scan is None else ("arm", "reflector"))],
                brief=True,
            ),
        ),
    )


def _scan_statements(result: Result) -> list[Statement]:
    """Return what is kept of the residuals of streamed distances, and which segments stand out."""
    scan = result.scan
    if scan is None:
        return []
    segments = scan.segments
    worst = max(range(len(segments.rms_um)), key=lambda i: segments.rms_um[i])
    texts = (
        f"Streamed: {scan.n_sample} of {scan.n_points} residuals kept one by one, all of them by segment.",
        f"Largest rms of a segment: {segments.rms_um[worst]:.2f} µm, {segments.reflector[worst]}/"
        f"{segments.segment[worst]}; largest residual {max(segments.largest_um):.2f} µm.",
    )
    return [Statement(Sign.NEUTRAL, text) for text in texts]
