"""How it was measured, gathered from stored runs."""

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime
from typing import Any

from catseye.app.cell.model import Cell
from catseye.app.results.numbers import utc_text
from catseye.app.results.runs.records import (
    DeviceRecord,
    EnvironmentSummary,
    Measurement,
    RunRecord,
    Spread,
)
from catseye.app.results.runs.timeline import incidents
from catseye.app.results.scara.measured_distances import measured_distances
from catseye.app.results.scara.path_rows import holds_distances
from catseye.app.store.reader import RunReader
from catseye.app.store.seal import read_manifest
from catseye.procedures.scara.aiming import search_result
from catseye.procedures.scara.records import PathPosition

_MEASURED_WITH = ("python", "numpy", "sqlite", "platform")


def measurement_of(readers: Sequence[RunReader], cell: Cell) -> Measurement:
    """Return what runs on one cell say about how it was measured."""
    events = [event for reader in readers for event in reader.events()]
    warnings = [str(event.data.get("text")) for event in events if event.kind == "warning"]
    origins: Any = readers[-1].meta.get("configuration_origins")
    searches = (search_result(reader) for reader in readers)
    return Measurement(
        runs=[_run_record(reader) for reader in readers],
        cell=cell,
        origins=origins or {},
        searches=[search for search in searches if search is not None],
        warnings=list(dict.fromkeys(warnings)),
        incidents=[
            f"{utc_text(moment.time_utc)}: {moment.text}"
            for reader in readers
            for moment in incidents(reader)
        ],
        devices=_devices(readers, cell),
        environment=_environment([row for reader in readers for row in _distances(reader)]),
        compensation=_compensation(readers),
    )


def _devices(readers: Sequence[RunReader], cell: Cell) -> list[DeviceRecord]:
    endpoints: dict[str, str] = {role: section.endpoint for role, section in cell.instruments.items()}
    answered: dict[str, DeviceRecord] = {}
    for reader in readers:
        devices: Any = reader.meta.get("devices") or {}
        for name, facts in devices.items():
            answered[name] = DeviceRecord(name=name, endpoint=endpoints.get(name, ""), **facts)
    return list(answered.values())


def _distances(reader: RunReader) -> list[dict[str, Any]]:
    """Return every distance with the air: points, returns, and those of a path that the interferometer measured."""
    path = reader.rows(PathPosition.table)
    return [*measured_distances(reader), *(path if holds_distances(path) else [])]


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
        healed=reader.heals().total(),
        software=f"catseye {measured_with.get('catseye', '')}",
        versions={key: str(measured_with[key]) for key in _MEASURED_WITH if key in measured_with},
        operator=str(reader.meta.get("operator", "")),
        files={} if manifest is None else {name: file.sha256 for name, file in manifest.files.items()},
    )
