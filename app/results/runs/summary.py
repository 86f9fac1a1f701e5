"""What a run came to, in a few lines above its story."""

import json
from collections import Counter
from collections.abc import Sequence
from typing import Any

from catseye.app.results.runs.event_text import between_s, device_text, gap_text
from catseye.app.results.runs.timeline import last_signs
from catseye.app.store.reader import RunReader
from catseye.app.store.resumable import why_not_resumable

Entry = tuple[str, str]
"""A label and its text."""

_RESULT = "solve"
_FEW = 20
"""A longer list of parameters is the content of a file."""


def summary(reader: RunReader) -> list[Entry]:
    """Return what was run, on what, how often it was interrupted, and what came out: texts with their labels."""
    meta: dict[str, Any] = dict(reader.meta)
    entries = [
        ("procedure", f"{meta.get('procedure')} on cell {meta.get('cell')}, operator {meta.get('operator')}"),
        ("params", json.dumps(_short(meta.get("params", {})), ensure_ascii=False)),
        ("aim", f"from {meta.get('aim')}"),
    ]
    entries += [(name, device_text(facts)) for name, facts in (meta.get("devices") or {}).items()]
    tables = ("steps", *(table.name for table in reader.tables()))
    counts = ", ".join(f"{count} {name}" for name in tables if (count := reader.count(name)))
    entries += [("stored", counts or "nothing"), *_interruptions(reader), *_reflectors(reader)]
    entries += [*_alignments(reader.records("alignment")), *_others(reader), *_results(reader)]
    if not why_not_resumable(reader):
        entries.append(("to go on", f"catseye resume {reader.path.name}"))
    return entries


def _short(params: dict[str, Any]) -> dict[str, Any]:
    """Return parameters with the rows of a file counted instead of listed."""
    rows = {name: value for name, value in params.items() if isinstance(value, list) and len(value) > _FEW}
    return {**params, **{name: f"{len(value)} rows" for name, value in rows.items()}}


def _interruptions(reader: RunReader) -> list[Entry]:
    last = last_signs(reader)
    reopened = [event for event in reader.events() if event.kind == "run-reopened"]
    ways = Counter(str(event.data.get("before")) for event in reopened)
    if not reopened:
        return []
    gaps = sum(between_s(last[event.seq], event.time_utc) for event in reopened)
    counts = ", ".join(f"{name} {count}×" for name, count in ways.items())
    return [
        (
            "interrupted",
            f"{counts}; {gap_text(gaps)} between the last record before and the going on, together",
        )
    ]


def _reflectors(reader: RunReader) -> list[Entry]:
    points = reader.rows("points")
    entries: list[Entry] = []
    for name in dict.fromkeys(row["reflector"] for row in points):
        own = [row for row in points if row["reflector"] == name]
        segments = len({row["segment"] for row in own})
        entries.append((str(name), f"{len(own)} distances in {segments} segment(s)"))
    lost = sum(event.kind == "beam-lost" for event in reader.events())
    return [*entries, ("beam lost", f"{lost}×")] if lost else entries


def _alignments(rows: Sequence[dict[str, Any]]) -> list[Entry]:
    entries: list[Entry] = []
    for quantity in dict.fromkeys(str(row.get("quantity")) for row in rows):
        own = [row for row in rows if str(row.get("quantity")) == quantity]
        before, after = own[0], own[-1]
        unit = before.get("unit", "")
        entries.append(
            (
                "alignment",
                f"{quantity}: {before['value']:+.3g} {unit} before, {after['value']:+.3g} {unit} after "
                f"{len(own)} round(s)",
            )
        )
    return entries


def _others(reader: RunReader) -> list[Entry]:
    """Return closures, drift and whatever else was observed: how often, and the largest change in µm."""
    rows = [row for row in reader.records() if row["kind"] not in {"alignment", "screw"}]
    entries: list[Entry] = []
    for kind in dict.fromkeys(str(row["kind"]) for row in rows):
        own = [row for row in rows if row["kind"] == kind]
        text = f"{len(own)}×"
        found = [change for row in own if (change := _change_um(row)) is not None]
        if found:
            text += f", largest change {max(found, key=abs):+.1f} µm"
        entries.append((kind, text))
    return entries


def _change_um(row: dict[str, Any]) -> float | None:
    for key, scale in (("drift_um", 1.0), ("change_um", 1.0), ("difference_um", 1.0), ("difference_mm", 1e3)):
        if isinstance(row.get(key), int | float):
            return float(row[key]) * scale
    return None


def _results(reader: RunReader) -> list[Entry]:
    return [
        ("result", f"{step.title}: {json.dumps(_readable(step.result), ensure_ascii=False)}")
        for step in reader.steps()
        if step.row_count == 0 and step.result and step.step_id == _RESULT
    ]


def _readable(value: Any) -> Any:
    """Return a result with its numbers to six digits; the record has all of them."""
    if isinstance(value, float):
        return float(f"{value:.6g}")
    if isinstance(value, dict):
        return {key: _readable(part) for key, part in value.items()}
    return [_readable(part) for part in value] if isinstance(value, list) else value
