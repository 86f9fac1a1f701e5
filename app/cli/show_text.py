"""What a run keeps, as text and as data."""

import textwrap
from datetime import datetime

from catseye.app.results.runs.summary import summary
from catseye.app.results.runs.timeline import timeline
from catseye.app.store.reader import RunReader
from catseye.app.store.resumable import why_not_resumable

_WIDTH = 116
_MARGIN = " " * 14


def run_facts(reader: RunReader) -> dict[str, object]:
    """Return what a run keeps as plain values."""
    return {
        "run": reader.path.name,
        "status": reader.status,
        "exit_code": reader.exit_code,
        "meta": reader.meta,
        "counts": {
            name: reader.count(name)
            for name in ("steps", *(table.name for table in reader.tables()), "events")
        },
        "results": {s.step_id: s.result for s in reader.steps() if s.row_count == 0 and s.result},
        "events": [{"t": e.time_utc, "kind": e.kind, "data": e.data} for e in reader.events()],
        "prompts": reader.prompts(),
        "resumable": not why_not_resumable(reader),
        **({"unverified": reader.unverified} if reader.unverified else {}),
        "story": [{"t": moment.time_utc, "text": moment.text} for moment in timeline(reader)],
    }


def run_lines(reader: RunReader) -> list[str]:
    """Return summary and timeline of a run as lines."""
    lines = [f"{reader.path.name}: {reader.status}", *(f"  UNVERIFIED: {text}" for text in reader.unverified)]
    lines += [*(f"  {line}" for line in summary(reader)), ""]
    day = ""
    for moment in timeline(reader):
        if moment.time_utc[:10] != day:
            day = moment.time_utc[:10]
            lines.append(f"  {day} (UTC)")
        first, *others = moment.text.splitlines()
        lines += _wrapped(first, f"  {_time_of_day(moment.time_utc)}  ")
        for other in others:
            lines += _wrapped(other, _MARGIN)
    return lines


def _time_of_day(time_utc: str) -> str:
    time = datetime.fromisoformat(time_utc)
    return f"{time:%H:%M:%S}.{time.microsecond // 100_000}"


def _wrapped(text: str, margin: str) -> list[str]:
    return textwrap.wrap(
        text,
        _WIDTH,
        initial_indent=margin,
        subsequent_indent=_MARGIN,
        break_long_words=False,
        break_on_hyphens=False,
    )
