"""The report of an arm: which sections stand in which order."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Final

from catseye.app.cell.model import Cell
from catseye.app.results.model import Bullets, Origin, Report, Section, Sign, Statement, section
from catseye.app.results.numbers import CONVENTION_OF_U, counted
from catseye.app.results.runs.records import Measurement, Sources
from catseye.app.results.runs.sections import (
    configuration_section,
    incident_section,
    run_section,
)
from catseye.app.results.runs.trace import trace_section
from catseye.app.results.scara.budget_text import budget_statements
from catseye.app.results.scara.compensation_proof import gain_statement
from catseye.app.results.scara.diagnosis_report import diagnosis_section
from catseye.app.results.scara.distance_report import distance_section, distance_statement
from catseye.app.results.scara.drift_text import drift_statements
from catseye.app.results.scara.figures.layout import layout_figure
from catseye.app.results.scara.findings import Findings
from catseye.app.results.scara.fit_text import fit_statements, identified_text, nodes_only_statements
from catseye.app.results.scara.layout import scene_of
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.result_report import (
    fit_section,
    map_section,
    parameter_section,
    reflector_section,
)
from catseye.app.results.scara.search_section import search_section
from catseye.app.results.scara.separated_text import separated_section, separated_statements
from catseye.app.results.scara.standards_report import standards_section
from catseye.app.results.scara.truth_tables import truth_statement
from catseye.app.results.scara.validation_report import path_section
from catseye.app.results.scara.validation_text import path_statement
from catseye.app.results.uncertainty_report import uncertainty_section

_MAPS: Final = ("figure-maps", "table-map1", "table-map2")
_PARAMETERS: Final = ("table-parameters", *_MAPS)
_FIT: Final = ("table-statistics", "figure-residuals")
_PATH: Final = ("table-models", "figure-path-x", "figure-path-y", "figure-trajectories")
_DISTANCES: Final = ("table-distance_models", "figure-path-distances")
_NO_RUNS: Final = Measurement()
_NO_SOURCES: Final = Sources()


def arm_report(
    title: str,
    origin: Origin,
    findings: Findings,
    measurement: Measurement = _NO_RUNS,
    sources: Sources = _NO_SOURCES,
) -> Report:
    """Return everything that is known about an arm, the verdict first."""
    sections = (
        *_result_sections(findings, measurement),
        *_run_sections(origin, findings, measurement, sources),
    )
    return Report(title, origin, sections)


def verdict(findings: Findings, incidents: int = 0) -> list[Statement]:
    """Return what a metrologist wants to know first."""
    best = findings.best
    if best is None:
        nothing = Statement(Sign.BAD, "Nothing was identified: there is no result to report.")
        return [] if findings.found else [nothing]
    identified = Statement(Sign.NEUTRAL, identified_text(best), see=_PARAMETERS)
    statements = [identified, *(replace(one, see=_FIT) for one in fit_statements(best))]
    doubts = [] if best.budget is None else budget_statements(best.budget)
    statements += [one for one in doubts if one.sign is Sign.ATTENTION]
    statements.append(
        replace(path_statement(findings.validation), see=_PATH)
        if findings.distances is None
        else replace(distance_statement(findings.distances), see=_DISTANCES)
    )
    gained = None if findings.validation is None else gain_statement(findings.validation)
    statements += [] if gained is None else [gained]
    if findings.truth is not None and best.model == "error-map":
        statements.append(replace(truth_statement(best, findings.truth), see=_MAPS))
    statements += [*separated_statements(best), *drift_statements(best), *nodes_only_statements(best)]
    # Segments that are too short, and single distances.
    left_out = [f"{len(best.fit.rejected)} left out"] if best.fit.rejected else []
    left_out += [f"{counted(incidents, 'incident')} on the way"] if incidents else []
    if left_out:
        statements.append(Statement(Sign.NEUTRAL, f"{' and '.join(left_out)}: see below."))
    return statements


def _result_sections(findings: Findings, measurement: Measurement) -> list[Section]:
    """Return what was found out."""
    best, truth = findings.best, findings.truth
    map_truth = truth if best is not None and best.model == "error-map" else None
    statements = verdict(findings, len(measurement.incidents))
    return [
        *findings.found,
        section("verdict", "Verdict", statements, brief=True),
        parameter_section(findings.models, truth),
        map_section(findings.error_map, truth),
        standards_section(findings.error_map),
        path_section(findings.validation, findings.error_map, findings.lines),
        distance_section(findings.distances),
        fit_section(findings.models),
        *([] if findings.progress is None else [findings.progress]),
        diagnosis_section(findings.diagnosis),
        _uncertainty_section(best, measurement.cell),
        separated_section(best),
        _layout_section(findings),
        reflector_section(best, map_truth),
    ]


def _run_sections(
    origin: Origin, findings: Findings, measurement: Measurement, sources: Sources
) -> list[Section]:
    """Return how it was measured, and what it can be traced to."""
    names = sorted({name for result in findings.results for name in result.provenance.runs})
    found = {one.key for one in findings.found}
    result_software = (result.provenance.software for result in findings.results)
    sections = [
        None if "search" in found else search_section(measurement.searches),
        incident_section(measurement.warnings, measurement.incidents),
        run_section(measurement, names),
        _convention_section(findings.results),
        configuration_section(measurement.cell, measurement.origins),
        trace_section(origin.software, sources, measurement.runs, result_software),
    ]
    return [one for one in sections if one is not None]


def _uncertainty_section(best: Result | None, cell: Cell | None) -> Section:
    """Return what the uncertainties stand on; where no result says it, the budget of the cell."""
    part = None if best is None else best.uncertainty
    if best is not None and best.budget is not None:
        return uncertainty_section(part, best.budget.contributor, budget_statements(best.budget))
    return uncertainty_section(part, [] if cell is None else cell.uncertainty.contributor)


def _layout_section(findings: Findings) -> Section:
    path_mm = None if findings.validation is None else findings.validation.path.command_mm
    scene = scene_of(findings.bench, findings.best, path_mm)
    return section("layout", "Layout", [None if scene is None else layout_figure(scene)])


def _convention_section(results: Sequence[Result]) -> Section:
    """Return what the numbers mean."""
    gauges = [f"Gauge of the {result.model} model: {result.gauge}." for result in results]
    texts = (
        CONVENTION_OF_U,
        "Angular positioning deviation Δθ: actual minus command angle; 1 mdeg = 0.001°.",
        "Direction of approach: + after real motion upwards, − after real motion downwards.",
        "Reversal error (ISO 230-2): positive direction of approach minus negative.",
        "Residuals and differences: measured minus predicted.",
        "Maps are piecewise linear between their nodes and never extrapolated.",
        "Origin: J1 axis. Distances cannot see a rotation of everything about J1; the gauge fixes it.",
        *dict.fromkeys(gauges),
    )
    return section("conventions", "Conventions", [Bullets("", texts)])
