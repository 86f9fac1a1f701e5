"""One timeline of everything that a run has stored."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

from catseye.app.protocol.procedures import declared_by
from catseye.app.results.runs.event_text import between_s, device_text, event_text, gap_text, texts_of
from catseye.app.results.runs.points import Point, points_of
from catseye.app.store.reader import RunReader, StoredEvent, StoredStep
from catseye.procedures.kit.event_text import plain_text
from catseye.procedures.kit.records import EXTRA, KEY, Observation, Record, Row

_INCIDENTS = frozenset({"beam-lost", "step-dropped", "run-reopened", "walk-waived"})
"""Events that disturbed a run, or whose reason a reader of its result has to know."""


@dataclass(frozen=True)
class Moment:
    """A line of the timeline.

    Attributes:
        time_utc: ISO 8601 UTC time.
        text: what happened.
    """

    time_utc: str
    text: str


_Order = tuple[int, str, int]
"""Place, then time, then rank among what shares both."""


@dataclass(frozen=True)
class _Entry:
    """Something stored: a finished line, or a step that may share one with its neighbours.

    Attributes:
        time_utc: ISO 8601 UTC time.
        text: the line; empty for a step.
        order: what comes before what; no clock counts where the record itself knows.
        step: the step.
        passing: only the last one of its kind counts.
        kind: of the event; empty for what is none.
    """

    time_utc: str
    text: str
    order: _Order
    step: StoredStep | None = None
    passing: bool = False
    kind: str = ""

    @property
    def group(self) -> str:
        """What steps of one line have in common; a line of its own otherwise."""
        return "" if self.step is None else self.step.step_id.rpartition("/")[0] or self.step.step_id


def timeline(reader: RunReader) -> list[Moment]:
    """Return what happened, in order; steps that follow one another without anything between share a line."""
    declared = declared_by(str(reader.meta.get("procedure")))
    types = declared.records if declared else ()
    points: dict[str, list[Point]] = {}
    for point in points_of(reader, types):
        points.setdefault(point.step_id, []).append(point)
    records = {
        step_id: [record_text(row, types) for row in rows]
        for step_id, rows in _rows_of(reader.records()).items()
    }
    entries = [*_event_entries(reader), *_prompt_entries(reader)]
    steps = reader.steps()
    orders = _orders([(step.place, step.done_utc) for step in steps])
    entries += [_Entry(step.done_utc, "", order, step) for step, order in zip(steps, orders, strict=True)]
    # Of what has one time, events stay before answers and steps; a death comes last.
    entries.sort(key=lambda entry: entry.order)
    moments: list[Moment] = []
    for group, found in groupby(_calmed(entries), key=lambda entry: entry.group):
        together = list(found)
        if group:
            steps = [entry.step for entry in together if entry.step is not None]
            moments += _step_moments(group, steps, points, records)
        else:
            moments += [Moment(entry.time_utc, entry.text) for entry in together]
    return moments


def incidents(reader: RunReader) -> list[Moment]:
    """Return what disturbed a run, in the order in which it was stored."""
    return [
        Moment(entry.time_utc, entry.text) for entry in _event_entries(reader) if entry.kind in _INCIDENTS
    ]


def _orders(stored: Sequence[tuple[int | None, str]]) -> list[_Order]:
    """Return the order of rows of one table, from their places and times.

    Rows of an older program have no place: among those of other tables they are put by the latest time so far, which
    a clock that was set back does not disorder within the table.
    """
    found: list[_Order] = []
    latest = ""
    for place, time_utc in stored:
        latest = max(latest, time_utc)
        found.append(_order(place, latest))
    return found


def _order(place: int | None, time_utc: str, rank: int = 0) -> _Order:
    return (0, time_utc, rank) if place is None else (place, "", rank)


def _calmed(entries: Iterable[_Entry]) -> list[_Entry]:
    """Keep of what is repeated while steps are done the last one, behind them."""
    calm: list[_Entry] = []
    waiting: list[_Entry] = []
    for entry in entries:
        if entry.passing:
            waiting = [entry]
            continue
        if waiting and (entry.step is None or calm[-1].group != entry.group):
            calm.append(replace(waiting.pop(), time_utc=calm[-1].time_utc))
        calm.append(entry)
    return calm + [replace(entry, time_utc=calm[-1].time_utc) for entry in waiting]


def _rows_of(rows: Iterable[dict[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    found: dict[str, list[dict[str, Any]]] = {}
    for row in rows:
        found.setdefault(str(row["step_id"]), []).append(row)
    return found


def _event_entries(reader: RunReader) -> list[_Entry]:
    entries: list[_Entry] = []
    meta, devices = reader.meta, None
    known = texts_of(str(meta.get("procedure")))
    last, events = last_signs(reader), reader.events()
    stored = [(event.place, event.time_utc) for event in events]
    orders = {event.seq: order for event, order in zip(events, _orders(stored), strict=True)}
    for event in _without_echoes(events):
        order = orders[event.seq]
        match event.kind:
            case "run-opened":
                texts = [_opened(meta)]
            case "run-reopened":
                entries += _death(event, last.get(event.seq, event.time_utc))
                texts = [_reopened(event, last.get(event.seq, event.time_utc))]
            case "devices":
                texts = _devices(event.data.get("devices"), devices)
                devices = event.data.get("devices")
            case _:
                texts = [event_text(event, known)]
        kind = event.kind
        passing = kind in known and known[kind].passing
        entries += [_Entry(event.time_utc, text, order, passing=passing, kind=kind) for text in texts if text]
    return entries


def _without_echoes(events: Iterable[StoredEvent]) -> Iterator[StoredEvent]:
    """Yield what happened; why a life ended is stored with its state, as an error and at its end, and shown once."""
    shown: set[str] = set()
    for event in events:
        match event.kind, event.data:
            case "run-reopened", _:
                shown.clear()
            case "state", {"state": "STOPPING" | "ABORTING", "reason": str(reason)}:
                shown.add(reason)
            case "error", {"text": str(text)} if text in shown:
                continue
            case "error", {"text": str(text)}:
                shown.add(text)
            case "run-ended", {"text": str(text)} if text in shown:
                yield replace(event, data={**event.data, "text": ""})
                continue
        yield event


def last_signs(reader: RunReader) -> dict[int, str]:
    """Return, for each time that a run went on, when it had stored something for the last time before."""
    events = reader.events()
    signs = [(event.place, event.time_utc, event.seq) for event in events]
    signs += [(step.place, step.done_utc, 0) for step in reader.steps()]
    signs += [
        (prompt["place"], str(prompt["answered_utc"] or prompt["asked_utc"]), 0)
        for prompt in reader.prompts()
    ]
    return {
        event.seq: max(_before(event, signs), default=(0, event.time_utc))[1]
        for event in events
        if event.kind == "run-reopened"
    }


def _before(event: StoredEvent, signs: Iterable[tuple[int | None, str, int]]) -> Iterator[tuple[int, str]]:
    """Yield place and time of what was stored before an event."""
    for place, time_utc, seq in signs:
        if event.place is None:
            if place is None and time_utc <= event.time_utc and seq < event.seq:
                yield 0, time_utc
        elif place is None or place < event.place:
            yield place or 0, time_utc


def _death(event: StoredEvent, time_utc: str) -> list[_Entry]:
    if event.data.get("before") != "died":
        return []
    # Right before the going on where places are known, else last of what has its time.
    order = (0, time_utc, 1) if event.place is None else (event.place, "", -1)
    return [_Entry(time_utc, "DIED: nothing was stored after this, the run was not closed", order)]


def _opened(meta: dict[str, Any]) -> str:
    software = meta.get("software") or {}
    return (
        f"opened by {meta.get('operator', 'an unknown operator')} on {software.get('host', 'an unknown host')} with "
        f"catseye {software.get('catseye', '?')}"
    )


def _reopened(event: StoredEvent, last_utc: str) -> str:
    software: Any = event.data.get("software") or {}
    after = gap_text(between_s(last_utc, event.time_utc))
    text = (
        f"RESUMED by {event.data.get('operator', 'an unknown operator')} on "
        f"{software.get('host', 'an unknown host')} with catseye {software.get('catseye', '?')}, {after} after it "
        f"{_was(str(event.data.get('before')))}"
    )
    if event.data.get("configuration_file"):
        text += f"; endpoints and time-outs now as in {event.data['configuration_file']}"
    return text


def _was(before: str) -> str:
    return before if before in {"died", "stopped", "failed"} else f"was {before}"


def _devices(present: Any, before: Any) -> list[str]:
    if not isinstance(present, dict):
        return []
    if present == before:
        return ["the same devices answer as before"]
    if before is None:
        return [f"devices answer: {', '.join(present)}"]
    changed = {name: facts for name, facts in present.items() if facts != before.get(name)}
    return [f"{name} is now {device_text(facts)}" for name, facts in changed.items()]


def _prompt_entries(reader: RunReader) -> list[_Entry]:
    entries = []
    asked_at = {
        (event.data.get("id"), event.data.get("asked_utc")): event
        for event in reader.events()
        if event.kind == "asked"
    }
    for prompt in reader.prompts():
        event = asked_at.pop((prompt["id"], prompt["asked_utc"]), None)
        entries += _answer_entries(prompt, prompt["place"] if event is None else event.place)
    for event in asked_at.values():
        text = f"QUESTION {event.data.get('id')}: {event.data.get('text')} (never answered)"
        entries.append(_Entry(event.time_utc, text, _order(event.place, event.time_utc)))
    return entries


def _answer_entries(prompt: dict[str, Any], asked_place: int | None) -> list[_Entry]:
    """Return a question and what became of it, each where it was stored."""
    name, asked, answered = prompt["id"], str(prompt["asked_utc"]), prompt["answered_utc"]
    question = _Entry(asked, f"QUESTION {name}: {prompt['text']}", _order(asked_place, asked))
    if answered is None:
        order = _order(prompt["place"], asked, 1)
        return [question, _Entry(asked, f"QUESTION {name} stayed without an answer", order)]
    after = gap_text(between_s(asked, str(answered)))
    answer = f"ANSWER {name}: “{prompt['answer']}”, {prompt['who']}, after {after}"
    return [question, _Entry(str(answered), answer, _order(prompt["place"], str(answered), 1))]


def _step_moments(
    group: str,
    steps: Sequence[StoredStep],
    points: dict[str, list[Point]],
    records: dict[str, list[str]],
) -> list[Moment]:
    """Return the line of steps that follow one another, and lines of what else was recorded in them."""
    observed = [Moment(step.done_utc, text) for step in steps for text in records.get(step.step_id, ())]
    measured = [step for step in steps if step.step_id in points]
    if observed and not measured and all(step.step_id in records for step in steps):
        return observed
    last = steps[-1]
    took = gap_text(between_s(steps[0].started_utc, last.done_utc))
    if measured:
        text = _points_text(steps, measured, points)
    elif len(steps) == 1:
        text = steps[0].title
    else:
        text = f"{group}: {len(steps)} steps, {steps[0].title} … {last.title}"
    return [Moment(last.done_utc, f"{text}, in {took}"), *observed]


def _points_text(
    steps: Sequence[StoredStep], measured: Sequence[StoredStep], points: dict[str, list[Point]]
) -> str:
    found = [point for step in measured for point in points[step.step_id]]
    names = "/".join(dict.fromkeys(point.target for point in found if point.target))
    segments = list(dict.fromkeys(point.segment for point in found if point.segment is not None))
    text = f"{names}: " if names else ""
    text += f"{_range([step.step_id for step in measured])} measured"
    text += f", segment {_span(segments)}" if segments else ""
    left_out = [step.step_id for step in steps if step not in measured]
    return text + (
        f"; without a distance: {', '.join(_number(name) for name in left_out)}" if left_out else ""
    )


def _range(step_ids: Sequence[str]) -> str:
    """Return points by their numbers, counted from 1."""
    if len(step_ids) == 1:
        return f"point {_number(step_ids[0])}"
    return f"points {_number(step_ids[0])}…{_number(step_ids[-1])}"


def _number(step_id: str) -> str:
    last = step_id.rpartition("/")[2]
    return str(int(last) + 1) if last.isdecimal() else last


def _span(segments: Sequence[int]) -> str:
    return str(segments[0]) if len(segments) == 1 else f"{segments[0]}…{segments[-1]}"


def record_text(row: Row, records: Iterable[type[Record]]) -> str:
    """Return an observation as a sentence.

    Args:
        records: types that the run's procedure declares.
    """
    own = {key: value for key, value in row.items() if key not in {*KEY, EXTRA, "kind"}}
    kind = str(row["kind"])
    known = (record for record in records if issubclass(record, Observation) and record.kind == kind)
    declared = next(known, None)
    return (declared.describe(own) if declared else "") or plain_text(kind, own)
