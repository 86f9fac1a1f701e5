"""What a run came to, in a few lines above its story."""

import json
from collections import Counter
from collections.abc import Sequence
from typing import Any

from catseye.app.protocol.procedures import declared_by
from catseye.app.results.runs.event_text import between_s, device_text, gap_text
from catseye.app.results.runs.timeline import last_signs
from catseye.app.store.reader import RunReader
from catseye.app.store.resumable import why_not_resumable
from catseye.procedures.kit.records import Observation, Record, Row

_RESULT = "solve"
_FEW = 20
"""A longer list of parameters is the content of a file."""


def summary(reader: RunReader) -> list[str]:
    """Return what was run, on what, how often it was interrupted, and what came out."""
    meta: dict[str, Any] = dict(reader.meta)
    declared = declared_by(str(meta.get("procedure")))
    types = declared.records if declared else ()
    lines = ["SIMULATED: every device is an emulator; these data say nothing about a real robot"]
    if not meta.get("simulated"):
        lines = []
    lines += [
        f"procedure       {meta.get('procedure')} on cell {meta.get('cell')}, operator {meta.get('operator')}",
        f"params          {json.dumps(_short(meta.get('params', {})), ensure_ascii=False)}",
        f"aim             from {meta.get('aim')}",
    ]
    lines += [f"{name:<16}{device_text(facts)}" for name, facts in (meta.get("devices") or {}).items()]
    tables = ("steps", *(table.name for table in reader.tables()))
    counts = ", ".join(f"{count} {name}" for name in tables if (count := reader.count(name)))
    lines += [f"stored          {counts or 'nothing'}", *_interruptions(reader), *_reflectors(reader, types)]
    lines += [*_observed(reader, types), *_results(reader)]
    if not why_not_resumable(reader):
        lines.append(f"to go on            catseye resume {reader.path.name}")
    return lines


def _short(params: dict[str, Any]) -> dict[str, Any]:
    """Return parameters with the rows of a file counted instead of told."""
    rows = {name: value for name, value in params.items() if isinstance(value, list) and len(value) > _FEW}
    return {**params, **{name: f"{len(value)} rows" for name, value in rows.items()}}


def _interruptions(reader: RunReader) -> list[str]:
    last = last_signs(reader)
    reopened = [event for event in reader.events() if event.kind == "run-reopened"]
    ways = Counter(str(event.data.get("before")) for event in reopened)
    if not reopened:
        return []
    gaps = sum(between_s(last[event.seq], event.time_utc) for event in reopened)
    told = ", ".join(f"{name} {count}×" for name, count in ways.items())
    return [
        f"interrupted     {told}; {gap_text(gaps)} between the last record before and the going on, together"
    ]


def _reflectors(reader: RunReader, types: Sequence[type[Record]]) -> list[str]:
    points = [row for kind in types if kind.is_point for row in reader.rows(kind.table)]
    lines = []
    for name in dict.fromkeys(row["reflector"] for row in points):
        own = [row for row in points if row["reflector"] == name]
        segments = len({row["segment"] for row in own})
        lines.append(f"{name!s:<16}{len(own)} distances in {segments} segment(s)")
    lost = sum(event.kind == "beam-lost" for event in reader.events())
    return [*lines, f"beam lost       {lost}×"] if lost else lines


def _observed(reader: RunReader, types: Sequence[type[Record]]) -> list[str]:
    """Return what was observed beside what the run measures."""
    known = {each.kind: each for each in types if issubclass(each, Observation)}
    by_kind: dict[str, list[Row]] = {}
    for row in reader.records():
        by_kind.setdefault(str(row["kind"]), []).append(row)
    lines = []
    for kind, rows in by_kind.items():
        lines += known[kind].summary(rows) if kind in known else [f"{kind:<16}{len(rows)}×"]
    return lines


def _results(reader: RunReader) -> list[str]:
    return [
        f"result          {step.title}: {json.dumps(_readable(step.result), ensure_ascii=False)}"
        for step in reader.steps()
        if step.row_count == 0 and step.result and step.step_id == _RESULT
    ]


def _readable(value: Any) -> Any:
    """Return a result with its numbers to six digits; the record has all of them."""
    if isinstance(value, float):
        return float(f"{value:.6g}")
    if isinstance(value, dict):
        return {key: _readable(one) for key, one in value.items()}
    return [_readable(one) for one in value] if isinstance(value, list) else value
