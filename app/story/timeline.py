"""One timeline of everything that a run has stored."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

from app.store.reader import RunReader, StoredEvent, StoredStep
from app.story.observations import record_text
from app.story.words import between_s, device_text, event_text, gap_text

_PASSING = frozenset({"map-known"})
"""Events that tell how far a quantity has got: what counts is the last one."""


@dataclass(frozen=True)
class Moment:
    """A line of the story.

    Attributes:
        time_utc: ISO 8601 UTC time.
        text: what happened.
    """

    time_utc: str
    text: str


@dataclass(frozen=True)
class _Entry:
    """Something stored: a finished line, or a step that may share one with its neighbours."""

    time_utc: str
    text: str
    step: StoredStep | None = None
    rank: int = 0
    passing: bool = False

    @property
    def group(self) -> str:
        """What steps of one line have in common; a line of its own otherwise."""
        return "" if self.step is None else self.step.step_id.rpartition("/")[0] or self.step.step_id


def timeline(reader: RunReader) -> list[Moment]:
    """Return what happened, in order; steps that follow one another without anything between share a line."""
    points = _rows_of(reader.points())
    records = _rows_of(reader.records())
    entries = [*_event_entries(reader), *_prompt_entries(reader)]
    entries += [_Entry(step.done_utc, "", step) for step in reader.steps()]
    # Of what has one time, events stay before answers and steps; a death comes last.
    entries.sort(key=lambda entry: (entry.time_utc, entry.rank))
    moments: list[Moment] = []
    for group, found in groupby(_calmed(entries), key=lambda entry: entry.group):
        together = list(found)
        if group:
            steps = [entry.step for entry in together if entry.step is not None]
            moments += _steps_told(group, steps, points, records)
        else:
            moments += [Moment(entry.time_utc, entry.text) for entry in together]
    return moments


def _calmed(entries: Iterable[_Entry]) -> list[_Entry]:
    """Keep of what is told again and again while steps are done the last one, behind them."""
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
    last = last_signs(reader)
    for event in _without_echoes(reader.events()):
        match event.kind:
            case "run-opened":
                texts = [_opened(meta)]
            case "run-reopened":
                entries += _death(event, last)
                texts = [_reopened(event, last.get(event.seq, event.time_utc))]
            case "devices":
                texts = _devices(event.data.get("devices"), devices)
                devices = event.data.get("devices")
            case _:
                texts = [event_text(event)]
        passing = event.kind in _PASSING
        entries += [_Entry(event.time_utc, text, passing=passing) for text in texts if text]
    return entries


def _without_echoes(events: Iterable[StoredEvent]) -> Iterator[StoredEvent]:
    """Yield what happened; why a life ended is stored with its state, as an error and at its end, and told once."""
    told: set[str] = set()
    for event in events:
        match event.kind, event.data:
            case "run-reopened", _:
                told.clear()
            case "state", {"state": "STOPPING" | "ABORTING", "reason": str(reason)}:
                told.add(reason)
            case "error", {"text": str(text)} if text in told:
                continue
            case "error", {"text": str(text)}:
                told.add(text)
            case "run-ended", {"text": str(text)} if text in told:
                yield replace(event, data={**event.data, "text": ""})
                continue
        yield event


def last_signs(reader: RunReader) -> dict[int, str]:
    """Return, for each time that a run went on, when it had stored something for the last time before."""
    times = [(event.time_utc, event.seq) for event in reader.events()]
    times += [(step.done_utc, 0) for step in reader.steps()]
    times += [(str(prompt["answered_utc"] or prompt["asked_utc"]), 0) for prompt in reader.prompts()]
    reopened = {event.seq: event.time_utc for event in reader.events() if event.kind == "run-reopened"}
    return {
        seq: max((time for time, number in times if time <= at and number < seq), default=at)
        for seq, at in reopened.items()
    }


def _death(event: StoredEvent, last: dict[int, str]) -> list[_Entry]:
    if event.data.get("before") != "died":
        return []
    time_utc = last.get(event.seq, event.time_utc)
    return [_Entry(time_utc, "DIED: nothing was stored after this, the run was not closed", rank=1)]


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
    told = {(prompt["id"], prompt["asked_utc"]) for prompt in reader.prompts()}
    for prompt in reader.prompts():
        asked, answered = str(prompt["asked_utc"]), prompt["answered_utc"]
        entries.append(_Entry(asked, f"QUESTION {prompt['id']}: {prompt['text']}"))
        if answered is None:
            entries.append(_Entry(asked, f"QUESTION {prompt['id']} stayed without an answer"))
        else:
            after = gap_text(between_s(asked, str(answered)))
            entries.append(
                _Entry(
                    str(answered),
                    f"ANSWER {prompt['id']}: “{prompt['answer']}”, {prompt['who']}, after {after}",
                )
            )
    for event in reader.events():
        if event.kind == "asked" and (event.data.get("id"), event.data.get("asked_utc")) not in told:
            entries.append(
                _Entry(
                    event.time_utc,
                    f"QUESTION {event.data.get('id')}: {event.data.get('text')} (never answered)",
                )
            )
    return entries


def _steps_told(
    group: str,
    steps: Sequence[StoredStep],
    points: dict[str, list[dict[str, Any]]],
    records: dict[str, list[dict[str, Any]]],
) -> list[Moment]:
    """Return the line of steps that follow one another, and lines of what else was recorded in them."""
    observed = [
        Moment(step.done_utc, record_text(row)) for step in steps for row in records.get(step.step_id, ())
    ]
    measured = [step for step in steps if step.step_id in points]
    if observed and not measured and all(step.step_id in records for step in steps):
        return observed
    last = steps[-1]
    took = gap_text(between_s(steps[0].started_utc, last.done_utc))
    if measured:
        text = _points_told(steps, measured, points)
    elif len(steps) == 1:
        text = steps[0].title
    else:
        text = f"{group}: {len(steps)} steps, {steps[0].title} … {last.title}"
    return [Moment(last.done_utc, f"{text}, in {took}"), *observed]


def _points_told(
    steps: Sequence[StoredStep], measured: Sequence[StoredStep], points: dict[str, list[dict[str, Any]]]
) -> str:
    rows = [row for step in measured for row in points[step.step_id]]
    names = list(dict.fromkeys(str(row["reflector"]) for row in rows))
    segments = list(dict.fromkeys(int(row["segment"]) for row in rows))
    told = f"{'/'.join(names)}: {_range([step.step_id for step in measured])} measured, segment {_span(segments)}"
    left_out = [step.step_id for step in steps if step not in measured]
    return told + (
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
