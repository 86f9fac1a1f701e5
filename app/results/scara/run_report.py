"""The report of a run, of a result, of a whole job: which sections stand in which order."""

from catseye.app.results.model import Bullets, Origin, Paragraph, Report, Section, Sign, Statement, section
from catseye.app.results.numbers import counted
from catseye.app.results.runs.sections import (
    configuration_section,
    incident_section,
    run_section,
    search_section,
)
from catseye.app.results.runs.trace import trace_section
from catseye.app.results.scara.content import ReportContent
from catseye.app.results.scara.diagnosis_report import diagnosis_section
from catseye.app.results.scara.distance_report import distance_section, distance_statement
from catseye.app.results.scara.figures.layout import layout_figure
from catseye.app.results.scara.fit_text import fit_statements, identified_text
from catseye.app.results.scara.layout import scene_of
from catseye.app.results.scara.result_report import (
    fit_section,
    map_section,
    parameter_section,
    reflector_section,
)
from catseye.app.results.scara.standards_report import standards_section
from catseye.app.results.scara.truth_tables import truth_statement
from catseye.app.results.scara.validation_report import path_section
from catseye.app.results.scara.validation_text import path_statement
from catseye.app.results.uncertainty_report import uncertainty_section


def run_report(content: ReportContent) -> Report:
    """Return everything that is known, the verdict first."""
    origin = Origin(content.software, content.created_utc, content.simulated, tuple(content.unverified))
    return Report(content.title, origin, tuple(_sections(content)))


def verdict(content: ReportContent) -> list[Statement]:
    """Return what a metrologist wants to know first."""
    best = content.best
    if best is None:
        return [Statement(Sign.BAD, "Nothing was identified: there is no result to report.")]
    statements = [Statement(Sign.NEUTRAL, identified_text(best)), *fit_statements(best)]
    statements.append(
        path_statement(content.validation)
        if content.distances is None
        else distance_statement(content.distances)
    )
    if content.truth is not None and best.model == "error-map":
        statements.append(truth_statement(best, content.truth))
    # Segments that are too short, and single distances.
    left_out = [f"{len(best.fit.rejected)} left out"] if best.fit.rejected else []
    left_out += [f"{counted(len(content.events), 'incident')} on the way"] if content.events else []
    if left_out:
        statements.append(Statement(Sign.NEUTRAL, f"{' and '.join(left_out)}: see below."))
    return statements


def _sections(content: ReportContent) -> list[Section]:
    best, truth = content.best, content.truth
    note = Paragraph("All uncertainties are standard uncertainties (k = 1).")
    budget = None if content.cell is None else content.cell.uncertainty.contributor
    sources = sorted({name for result in content.results for name in result.provenance.runs})
    return [
        section("verdict", "Verdict", [*verdict(content), note], brief=True),
        parameter_section(content.models, truth),
        map_section(content.error_map, truth),
        standards_section(content.error_map),
        path_section(content.validation, content.error_map, content.lines),
        distance_section(content.distances),
        fit_section(content.models),
        diagnosis_section(content.diagnosis),
        uncertainty_section(None if best is None else best.uncertainty, budget),
        _layout_section(content),
        reflector_section(best, truth if best is not None and best.model == "error-map" else None),
        search_section(content.search),
        incident_section(content.warnings, content.events),
        run_section(content.runs, sources, content.devices, content.environment, content.compensation),
        _convention_section(content),
        configuration_section(content.cell, content.origins),
        trace_section(
            content.software,
            content.versions,
            content.runs,
            (result.provenance.software for result in content.results),
            content.digests,
        ),
    ]


def _layout_section(content: ReportContent) -> Section:
    path_mm = None if content.validation is None else content.validation.path.command_mm
    scene = scene_of(content.bench, content.best, path_mm)
    return section("layout", "Layout", [None if scene is None else layout_figure(scene)])


def _convention_section(content: ReportContent) -> Section:
    """Return what the numbers mean."""
    gauges = [f"Gauge of the {result.model} model: {result.gauge}." for result in content.results]
    texts = (
        "All uncertainties are standard uncertainties (k = 1).",
        "Angular positioning deviation Δθ: actual minus command angle; 1 mdeg = 0.001°.",
        "Direction of approach: + after real motion upwards, − after real motion downwards.",
        "Reversal error: the map of the negative direction minus that of the positive one.",
        "Maps are piecewise linear between their nodes and never extrapolated.",
        "Origin: J1 axis. Distances cannot see a rotation of everything about J1; the gauge fixes it.",
        *dict.fromkeys(gauges),
    )
    return section("conventions", "Conventions", [Bullets("", texts)])
