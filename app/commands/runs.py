"""runs, show, verify: the store."""

import json
from pathlib import Path
from typing import Any

from app.commands.output import emit, emit_json, say, table
from app.errors import StorageError
from app.runs_folder import runs_folder
from app.store.catalog import list_runs, resolve_run
from app.store.reader import RunReader
from app.store.verify import verify

_LONGEST_CELL = 100


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
                }
            )
        return
    if not summaries:
        say(f"no runs in {root}; start one with: catseye run PROCEDURE --cell FILE")
        return
    emit(
        table(
            ["id", "started", "procedure", "status"],
            [[r.id, r.started, r.procedure, r.status] for r in summaries],
        )
    )


def show_command(run: str, runs: Path | None, as_json: bool) -> None:
    """Tell a run's story."""
    reader = RunReader(resolve_run(runs_folder(runs), run))
    meta = reader.meta
    if as_json:
        emit_json(_facts(reader, meta))
        return
    emit(f"{reader.path.name}: {reader.status}")
    for line in _story(reader, meta):
        emit(line)


def verify_command(run: str, runs: Path | None, as_json: bool) -> None:
    """Check a run; exit code 6 when something is wrong."""
    path = resolve_run(runs_folder(runs), run)
    problems = verify(path).problems
    if as_json:
        emit_json({"run": path.name, "sound": not problems, "problems": problems})
    elif not problems:
        say(f"{path.name}: manifest, database and sequence numbers agree")
    if problems:
        raise StorageError(f"{path.name}: " + "; ".join(problems))


def _facts(reader: RunReader, meta: dict[str, Any]) -> dict[str, object]:
    return {
        "run": reader.path.name,
        "status": reader.status,
        "exit_code": reader.exit_code,
        "meta": meta,
        "counts": {
            name: reader.count(name) for name in ("steps", "points", "search", "path", "records", "events")
        },
        "results": {s.step_id: s.result for s in reader.steps() if s.row_count == 0 and s.result},
        "events": [{"t": e.time_utc, "kind": e.kind, "data": e.data} for e in reader.events()],
        "prompts": reader.prompts(),
    }


def _story(reader: RunReader, meta: dict[str, Any]) -> list[str]:
    lines = [
        f"  procedure  {meta.get('procedure')} on cell {meta.get('cell')}, operator {meta.get('operator')}",
        f"  params     {json.dumps(meta.get('params', {}), ensure_ascii=False)}; aim from {meta.get('aim')}",
        f"  devices    {'SIMULATED' if meta.get('simulated') else 'real'}",
    ]
    devices = meta.get("devices") or {}
    lines += [
        f"    {name}: {facts['model']} {facts['firmware']} {facts['serial']}".rstrip()
        for name, facts in devices.items()
    ]
    counts = ", ".join(
        f"{reader.count(name)} {name}" for name in ("steps", "points", "search", "path", "records")
    )
    lines.append(f"  stored     {counts}")
    lines += [
        f"  result     {s.title}: {json.dumps(s.result, ensure_ascii=False)}"
        for s in reader.steps()
        if s.row_count == 0 and s.result and s.step_id == "solve"
    ]
    lines.append("  events")
    for event in reader.events():
        data = json.dumps(event.data, ensure_ascii=False)
        short = data if len(data) <= _LONGEST_CELL else data[: _LONGEST_CELL - 1] + "…"
        lines.append(f"    {event.time_utc[11:23]}  {event.kind:<14} {short}")
    return lines
