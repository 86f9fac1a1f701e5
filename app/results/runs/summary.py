"""What a run came to, in a few lines above its timeline."""

from collections import Counter
from collections.abc import Sequence
from typing import Any

from catseye.app.protocol.parameters import parameter_label, value_text
from catseye.app.protocol.procedures import declared_by
from catseye.app.results.runs.event_text import between_s, device_text, gap_text, heals_text
from catseye.app.results.runs.points import points_of
from catseye.app.results.runs.timeline import last_signs
from catseye.app.store.reader import RunReader
from catseye.app.store.resumable import why_not_resumable
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Observation, Record, Row

Entry = tuple[str, str]
"""A label and its text."""

_FEW = 20
"""A longer list of parameters is the content of a file."""


def summary(reader: RunReader) -> list[Entry]:
    """Return what was run, on what, how often it was interrupted, and what came out: texts with their labels."""
    meta: dict[str, Any] = dict(reader.meta)
    declared = declared_by(str(meta.get("procedure")))
    types = declared.records if declared else ()
    entries = [
        ("procedure", f"{meta.get('procedure')} on cell {meta.get('cell')}, operator {meta.get('operator')}"),
        ("parameters", "\n".join(_parameters(meta.get("params", {}), declared)) or "those of the program"),
    ]
    if declared is None or declared.needs.basis is not None:
        entries.append(("aim", f"from {meta.get('aim')}"))
    entries += [(name, device_text(facts)) for name, facts in (meta.get("devices") or {}).items()]
    tables = ("steps", *(table.name for table in reader.tables()))
    counts = ", ".join(f"{count} {name}" for name in tables if (count := reader.count(name)))
    entries += [("stored", counts or "nothing"), *_interruptions(reader), *_targets(reader, types)]
    if heals := heals_text(reader.heals()):
        entries.append(("links healed", heals))
    entries += _observed(reader, types)
    if not why_not_resumable(reader):
        entries.append(("to go on", f"catseye resume {reader.path.name}"))
    return entries


def _parameters(given: dict[str, Any], declared: Procedure | None) -> list[str]:
    """Return parameters with their labels, without those that are left to the program."""
    facts = declared.params_type.model_json_schema().get("properties", {}) if declared else {}
    texts = {name: value_text(_named(value)) for name, value in given.items()}
    return [f"{parameter_label(name, facts.get(name, {}))}: {text}" for name, text in texts.items() if text]


def _named(value: Any) -> Any:
    """Return a value, of a file only how many rows it had, of a result only its format."""
    if isinstance(value, list) and len(value) > _FEW:
        return f"{len(value)} rows"
    if isinstance(value, list) and all(isinstance(one, str) for one in value):
        return ", ".join(value)
    return (value.get("format") or value or None) if isinstance(value, dict) else value


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


def _targets(reader: RunReader, types: Sequence[type[Record]]) -> list[Entry]:
    """Return how much was measured at each target, and how often the beam was lost."""
    points = points_of(reader, types)
    entries: list[Entry] = []
    for name in dict.fromkeys(point.target for point in points if point.target):
        own = [point for point in points if point.target == name]
        segments = {point.segment for point in own} - {None}
        counted = f"{len(own)} distances in {len(segments)} segment(s)" if segments else f"{len(own)} points"
        entries.append((name, counted))
    lost = sum(event.kind == "beam-lost" for event in reader.events())
    return [*entries, ("beam lost", f"{lost}×")] if lost else entries


def _observed(reader: RunReader, types: Sequence[type[Record]]) -> list[Entry]:
    """Return what was observed beside what the run measures."""
    known = {each.kind: each for each in types if issubclass(each, Observation)}
    by_kind: dict[str, list[Row]] = {}
    for row in reader.records():
        by_kind.setdefault(str(row["kind"]), []).append(row)
    entries: list[Entry] = []
    for kind, rows in by_kind.items():
        texts = known[kind].summary(rows) if kind in known else [f"{len(rows)}×"]
        entries += [(kind, text) for text in texts]
    return entries
