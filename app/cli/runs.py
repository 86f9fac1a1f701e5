"""runs, show, verify: the store."""

import textwrap
from datetime import datetime
from pathlib import Path

from catseye.app.cli.output import emit, emit_json, say, table
from catseye.app.errors import StorageError
from catseye.app.runs_folder import runs_folder
from catseye.app.store.catalog import RunSummary, list_runs, resolve_run
from catseye.app.store.reader import Accept, RunReader, accept
from catseye.app.store.resumable import why_not_resumable
from catseye.app.store.unverified import taken_as_it_is
from catseye.app.store.verify import Verification, verify
from catseye.app.story.summary import summary
from catseye.app.story.timeline import timeline

_WIDTH = 116
_MARGIN = " " * 14


def runs_command(runs: Path | None, as_json: bool) -> None:
    """List the runs."""
    root = runs_folder(runs)
    summaries = list_runs(root)
    if as_json:
        for run in summaries:
            emit_json(
                {
                    "run": run.name,
                    "id": run.id,
                    "procedure": run.procedure,
                    "started": run.started,
                    "status": run.status,
                    "path": str(run.path),
                    "resumable": _resumable(run),
                }
            )
        return
    if not summaries:
        say(f"no runs in {root}; start one with: catseye run PROCEDURE --cell FILE")
        return
    emit(
        table(
            ["id", "started", "procedure", "status", "to go on"],
            [
                [r.id, r.started, r.procedure, r.status, f"catseye resume {r.id}" if _resumable(r) else ""]
                for r in summaries
            ],
        )
    )


def show_command(run: str, runs: Path | None, as_json: bool, unverified: bool = False) -> None:
    """Tell a run's story."""
    reader = RunReader(resolve_run(runs_folder(runs), run), accept(unverified=unverified))
    with taken_as_it_is(reader):
        if as_json:
            emit_json(_facts(reader))
            return
        for line in _told(reader):
            emit(line)


def verify_command(run: str, runs: Path | None, as_json: bool) -> None:
    """Check a run; exit code 6 when something is wrong."""
    path = resolve_run(runs_folder(runs), run)
    found = verify(path)
    if as_json:
        emit_json(
            {
                "run": path.name,
                "sound": found.ok,
                "sealed": found.sealed,
                "problems": found.problems,
                "notes": found.notes,
            }
        )
    else:
        _tell_verified(path.name, found)
    if found.problems:
        raise StorageError(f"{path.name}: " + "; ".join(found.problems))


def _tell_verified(name: str, found: Verification) -> None:
    if found.ok:
        compared = "manifest, database" if found.sealed else "database"
        say(f"{name}: {compared} and sequence numbers agree")
    for note in found.notes:
        say(f"{name}: {note}")


def _resumable(run: RunSummary) -> bool:
    if run.status in {"complete", "running", "damaged"}:
        return False
    try:
        return not why_not_resumable(RunReader(run.path, Accept.UNCHECKED))
    except StorageError:
        # The others are listed all the same; whoever opens it learns why.
        return False


def _facts(reader: RunReader) -> dict[str, object]:
    return {
        "run": reader.path.name,
        "status": reader.status,
        "exit_code": reader.exit_code,
        "meta": reader.meta,
        "counts": {
            name: reader.count(name) for name in ("steps", "points", "search", "path", "records", "events")
        },
        "results": {s.step_id: s.result for s in reader.steps() if s.row_count == 0 and s.result},
        "events": [{"t": e.time_utc, "kind": e.kind, "data": e.data} for e in reader.events()],
        "prompts": reader.prompts(),
        "resumable": not why_not_resumable(reader),
        **({"unverified": reader.unverified} if reader.unverified else {}),
        "story": [{"t": moment.time_utc, "text": moment.text} for moment in timeline(reader)],
    }


def _time_of_day(time_utc: str) -> str:
    time = datetime.fromisoformat(time_utc)
    return f"{time:%H:%M:%S}.{time.microsecond // 100_000}"


def _told(reader: RunReader) -> list[str]:
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


def _wrapped(text: str, margin: str) -> list[str]:
    return textwrap.wrap(
        text,
        _WIDTH,
        initial_indent=margin,
        subsequent_indent=_MARGIN,
        break_long_words=False,
        break_on_hyphens=False,
    )
