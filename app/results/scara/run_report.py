"""Reports of stored runs, of result files, of a whole job."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from catseye.app.results.model import Report
from catseye.app.results.origin import origin_now
from catseye.app.results.runs.declared_result import declared_sections
from catseye.app.results.runs.run_source import are_simulated, cell_of_run, origin_of_run
from catseye.app.results.runs.trace import sources_of
from catseye.app.results.scara.arm_report import arm_report
from catseye.app.results.scara.diagnosis import diagnose_points
from catseye.app.results.scara.findings import Findings
from catseye.app.results.scara.found.measuring import measuring_section
from catseye.app.results.scara.found.sections import scara_sections
from catseye.app.results.scara.identify import (
    MODELS,
    aimed_bench,
    bench_of_runs,
    identified_result,
    identify_points,
    run_points,
)
from catseye.app.results.scara.material import with_reference_links
from catseye.app.results.scara.measurement import measurement_of
from catseye.app.results.scara.path_of_run import compare_path
from catseye.app.results.scara.plausible import ImplausibleError
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.scara.stated_budget import budget_of_runs
from catseye.app.results.scara.truth_tables import TruthTables
from catseye.app.results.scara.uncertainty import by_jacobian
from catseye.app.results.scara.validation import PathValidation
from catseye.app.store.reader import RunReader
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis
from catseye.procedures.scara.records import Distance, PathPosition


def job_report(
    title: str,
    runs: Sequence[RunReader],
    measured: RunReader,
    results: Sequence[Result],
    truth: TruthTables | None,
    validation: PathValidation | None,
) -> Report:
    """Return the report of several runs of one job.

    Args:
        runs: all of them, in order.
        validation: models on an independently measured path.
    """
    bench = bench_of_runs([measured], measured.path.parent)
    return arm_report(
        title,
        origin_now(simulated=bool(are_simulated(runs))),
        Findings(results, bench, truth, validation),
        measurement_of(runs, cell_of_run(measured)),
        sources_of(),
    )


def run_report(reader: RunReader, root: Path) -> Report:
    """Return the report of a run: measurements identified with both models, paths compared with both."""
    cell = cell_of_run(reader)
    findings, notes = _findings(reader, root)
    measurement = measurement_of([reader], cell)
    return arm_report(
        f"{reader.meta.get('procedure')} on {cell.name}",
        origin_of_run(reader),
        findings,
        replace(measurement, warnings=[*measurement.warnings, *notes]),
        sources_of(),
    )


def result_file_report(source: Path) -> Report:
    """Return the report of a result file."""
    result = read_result(source)
    provenance = result.provenance
    return arm_report(
        f"Result {source.name}",
        provenance.origin,
        Findings([result]),
        sources=sources_of([source]),
    )


def _findings(reader: RunReader, root: Path) -> tuple[Findings, list[str]]:
    """Return what a run is worth, and what could not be done."""
    bench, diagnosis = aimed_bench(reader, root), _diagnosed(reader, root)
    if reader.count(PathPosition.table):
        compared = compare_path(reader, root)
        findings = Findings(
            compared.results,
            bench,
            validation=compared.validation,
            distances=compared.distances,
            diagnosis=diagnosis,
            # Without a model the path still says how far the arm was from it.
            found=() if compared.results else scara_sections(reader),
        )
        return findings, compared.notes
    results, notes = _identified(reader, root) if reader.rows(Distance.table) else ([], [])
    found, progress = scara_sections(reader) or declared_sections(reader), measuring_section(reader)
    return Findings(results, bench, diagnosis=diagnosis, found=found, progress=progress), notes


def _identified(reader: RunReader, root: Path) -> tuple[list[Result], list[str]]:
    """Return both models as far as the points determine them, and what could not be done."""
    bench, points, stated = bench_of_runs([reader], root), run_points([reader]), budget_of_runs([reader])
    results, notes = [], []
    for model in MODELS:
        try:
            one = identify_points(points, bench, model, stated.budget)
        except (CalibrationError, ImplausibleError) as error:
            notes.append(f"the {model} model could not be identified: {error}")
            continue
        result = with_reference_links(
            identified_result(one, bench, [reader.path.name], stated.part, are_simulated([reader])), [reader]
        )
        results.append(result.model_copy(update={"uncertainty": by_jacobian(one).part}))
    return results, notes


def _diagnosed(reader: RunReader, root: Path) -> Diagnosis | None:
    """Return what speaks for and against the error map; None where there is none, which the notes explain."""
    if not reader.rows(Distance.table):
        return None
    bench, budget = bench_of_runs([reader], root), budget_of_runs([reader]).budget
    try:
        return diagnose_points(run_points([reader]), bench, budget)
    except (CalibrationError, ImplausibleError):
        return None
