"""What a report shows, gathered from stored runs and result files."""

import hashlib
import platform
from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from catseye.app.cell.model import Cell
from catseye.app.files.documents import LARGEST_RESULT_BYTES, read_document
from catseye.app.results.origin import now_utc
from catseye.app.results.runs.records import DeviceRecord, EnvironmentSummary, RunRecord, Spread
from catseye.app.results.scara.content import ReportContent
from catseye.app.results.scara.identify import (
    MODELS,
    aimed_bench,
    are_simulated,
    bench_of_runs,
    cell_of_run,
    error_budget,
    identified_result,
    identify_points,
    problem_of_points,
    run_points,
)
from catseye.app.results.scara.material import with_reference_links
from catseye.app.results.scara.path_of_run import compare_path
from catseye.app.results.scara.path_rows import holds_distances
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.scara.truth import gauge_turn_rad, turned_places
from catseye.app.results.scara.truth_tables import TruthMap, TruthTables
from catseye.app.results.scara.uncertainty import by_jacobian
from catseye.app.results.scara.validation import PathValidation
from catseye.app.store.basis import search_result
from catseye.app.store.reader import RunReader
from catseye.app.store.seal import read_manifest
from catseye.app.store.software import SOFTWARE
from catseye.calibration.core.errors import CalibrationError
from catseye.calibration.scara.diagnostics.diagnosis import Diagnosis, diagnose
from catseye.calibration.scara.identification import Identification
from catseye.procedures.scara.records import Distance, PathPosition

_MEASURED_WITH = ("python", "numpy", "sqlite", "platform")

_TOLD_EVENTS = ("beam-lost", "step-dropped", "run-reopened", "walk-waived")


def job_content(
    title: str,
    runs: Sequence[RunReader],
    measured: RunReader,
    results: Sequence[Result],
    truth: TruthTables | None,
    validation: PathValidation | None,
) -> ReportContent:
    """Return what a report of several runs of one job shows.

    Args:
        title: heading.
        runs: all of them, in order.
        measured: the one with the distances.
        results: identified models.
        truth: what an emulated bench really is.
        validation: models on an independently measured path.
    """
    return ReportContent(
        title=title,
        results=results,
        truth=truth,
        validation=validation,
        bench=bench_of_runs([measured], measured.path.parent),
        **_run_parts(runs, cell_of_run(measured)),
    )


def run_content(reader: RunReader, root: Path) -> ReportContent:
    """Return what a report of a run shows: measurements identified with both models, paths compared with both."""
    cell = cell_of_run(reader)
    results, notes = _identified(reader, root) if reader.rows(Distance.table) else ([], [])
    parts = _run_parts([reader], cell) | {"diagnosis": _diagnosed(reader, root)}
    if reader.count(PathPosition.table):
        compared = compare_path(reader, root)
        results, notes = compared.results, compared.notes
        parts |= {"validation": compared.validation, "distances": compared.distances}
    parts["warnings"] = [*parts["warnings"], *notes]
    parts["unverified"] = reader.unverified
    title = f"{reader.meta.get('procedure')} on {cell.name}"
    return ReportContent(title=title, results=results, bench=aimed_bench(reader, root), **parts)


def result_content(source: Path) -> ReportContent:
    """Return what a report of a result file shows."""
    result = read_result(source)
    document = read_document(source, largest_bytes=LARGEST_RESULT_BYTES)
    return ReportContent(
        title=f"Result {source.name}",
        created_utc=now_utc(),
        software=SOFTWARE,
        simulated=bool(result.provenance.simulated),
        results=[result],
        versions=_versions(),
        unverified=result.provenance.unverified or (),
        digests={source.name: hashlib.sha256(document).hexdigest()},
    )


def truth_tables(identified: Identification, document: dict[str, Any]) -> TruthTables:
    """Return a truth document in the gauge of an identification."""
    turn = gauge_turn_rad(identified, document)
    return TruthTables(
        link1_mm=document["link1_mm"]["value"],
        link2_mm=document["link2_mm"]["value"],
        theta1_map=_truth_map(document["theta1_map"], 1e3 * float(np.rad2deg(turn))),
        theta2_map=_truth_map(document["theta2_map"], 0.0),
        reflectors_mm=turned_places(document, turn),
    )


def _truth_map(table: Mapping[str, Any], shift_mdeg: float) -> TruthMap:
    return TruthMap(
        table["node_deg"],
        [value - shift_mdeg for value in table["positive_mdeg"]],
        [value - shift_mdeg for value in table["negative_mdeg"]],
    )


def _identified(reader: RunReader, root: Path) -> tuple[list[Result], list[str]]:
    """Return both models as far as the points determine them, and what could not be done."""
    bench, points = bench_of_runs([reader], root), run_points([reader])
    results, notes = [], []
    for model in MODELS:
        try:
            one = identify_points(points, bench, model, error_budget(cell_of_run(reader)))
        except CalibrationError as error:
            notes.append(f"the {model} model could not be identified: {error}")
            continue
        result = with_reference_links(
            identified_result(one, bench, [reader.path.name], are_simulated([reader])), [reader]
        )
        results.append(result.model_copy(update={"uncertainty": by_jacobian(one).part}))
    return results, notes


def _diagnosed(reader: RunReader, root: Path) -> Diagnosis | None:
    """Return what speaks for and against the error map; None where there is none, which the notes tell."""
    if not reader.rows(Distance.table):
        return None
    bench, budget = bench_of_runs([reader], root), error_budget(cell_of_run(reader))
    try:
        return diagnose(problem_of_points(run_points([reader]), bench, "error-map", budget))
    except CalibrationError:
        return None


def _run_parts(readers: Sequence[RunReader], cell: Cell) -> dict[str, Any]:
    events = [event for reader in readers for event in reader.events()]
    searches = [found for reader in readers if (found := search_result(reader)) is not None]
    warnings = [str(e.data.get("text")) for e in events if e.kind == "warning"]
    return {
        "created_utc": now_utc(),
        "software": SOFTWARE,
        "simulated": bool(are_simulated(readers)),
        "cell": cell,
        "origins": readers[-1].meta.get("configuration_origins") or {},
        "search": searches,
        "warnings": list(dict.fromkeys(warnings)),
        "events": [f"{e.time_utc[:19]} {e.kind}: {_facts(e.data)}" for e in events if e.kind in _TOLD_EVENTS],
        "devices": _devices(readers, cell),
        "environment": _environment([row for reader in readers for row in _distances(reader)]),
        "compensation": _compensation(readers),
        "runs": [_run_record(reader) for reader in readers],
        "versions": _versions(),
    }


def _facts(data: Mapping[str, object]) -> str:
    return ", ".join(f"{key} {value}" for key, value in data.items())


def _devices(readers: Sequence[RunReader], cell: Cell) -> list[DeviceRecord]:
    endpoints = {
        "robot": cell.robot.endpoint,
        "interferometer": cell.interferometer.endpoint,
        "environment": cell.environment.endpoint,
        "tracker": "" if cell.tracker is None else cell.tracker.endpoint,
    }
    found: dict[str, DeviceRecord] = {}
    for reader in readers:
        devices: Any = reader.meta.get("devices") or {}
        for name, facts in devices.items():
            found[name] = DeviceRecord(name=name, endpoint=endpoints.get(name, ""), **facts)
    return list(found.values())


def _distances(reader: RunReader) -> list[dict[str, Any]]:
    """Return every row with a distance and the air: points, and those of a path that the interferometer measured."""
    path = reader.rows(PathPosition.table)
    return [*reader.rows(Distance.table), *(path if holds_distances(path) else [])]


def _environment(points: Sequence[Mapping[str, Any]]) -> EnvironmentSummary | None:
    if not points:
        return None
    return EnvironmentSummary(
        *(
            _spread(point[key] for point in points)
            for key in ("temperature_c", "pressure_hpa", "humidity_percent")
        )
    )


def _compensation(readers: Sequence[RunReader]) -> list[str]:
    """Return who corrected the lengths for the air; runs of earlier versions do not say it."""
    facts = [reader.meta.get("compensation") for reader in readers if _distances(reader)]
    return list(dict.fromkeys(str(fact["sentence"]) for fact in facts if isinstance(fact, dict)))


def _spread(values: Iterable[float | None]) -> Spread | None:
    known = [value for value in values if value is not None]
    return Spread(min(known), sum(known) / len(known), max(known)) if known else None


def _run_record(reader: RunReader) -> RunRecord:
    events = reader.events()
    start, end = (datetime.fromisoformat(events[i].time_utc) for i in (0, -1))
    measured_with: Any = reader.meta.get("software") or {}
    manifest = read_manifest(reader.path)
    return RunRecord(
        name=reader.path.name,
        procedure=str(reader.meta.get("procedure")),
        status=reader.status,
        started_utc=events[0].time_utc,
        duration_s=(end - start).total_seconds(),
        points=reader.measured or None,
        software=f"catseye {measured_with.get('catseye', '')}",
        versions={key: str(measured_with[key]) for key in _MEASURED_WITH if key in measured_with},
        operator=str(reader.meta.get("operator", "")),
        files={} if manifest is None else {name: file.sha256 for name, file in manifest.files.items()},
    )


def _versions() -> dict[str, str]:
    """Return what this program runs on."""
    packages = {name: version(name) for name in ("numpy", "scipy", "matplotlib")}
    return {"python": platform.python_version(), **packages, "platform": platform.platform()}
