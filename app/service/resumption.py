"""Going on with a run that stopped, failed, was aborted or died: planned from what it has stored."""

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from catseye.app.cell.bench import bench_of, system_of
from catseye.app.cell.load import LoadedCell, load_cell
from catseye.app.cell.model import Cell, Hooks
from catseye.app.engine.walked.register import WALK, own_legs
from catseye.app.errors import ConfigError, StorageError, UsageError
from catseye.app.files.flat import flattened
from catseye.app.protocol.procedures import Runnable, load_procedure
from catseye.app.service.plan_digest import plan_digest
from catseye.app.service.planned_walk import as_walk
from catseye.app.service.running import PlannedRun, stored_cell
from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader
from catseye.app.store.resumable import why_not_resumable, writer_of


def plan_resume(root: Path, run: str, changed: LoadedCell | None = None) -> PlannedRun:
    """Plan the rest of an interrupted run exactly as the whole was planned.

    Everything comes from the run: neither its cell file nor the search that it was aimed with has to be there any
    more. `carry_out` and `rehearse` take what is returned as they take a new run's plan; steps that are done return
    their stored results. Nothing is written and no device is touched here.

    Args:
        run: path, name, beginning of a name, or id.
        changed: a cell file with other endpoints, or time-outs, than those of last time.

    Raises:
        UsageError: the run is complete or under way, its reflectors were moved, an older program wrote it without
            what is needed, this program plans it differently, or the cell file differs in more than endpoints and
            time-outs; the text names the keys.
        ProcedureError: the plan cannot be made.
        StorageError: the run cannot be read.
    """
    path = resolve_run(root, run)
    reader = RunReader(path)
    _require_resumable(reader)
    _require_whole(reader)
    meta: dict[str, Any] = dict(reader.meta)
    loaded = _configured(reader, meta)
    if changed is not None:
        _require_same_but_links(path.name, loaded.cell, changed.cell)
        loaded = changed
    else:
        loaded = replace(
            loaded, cell=loaded.cell.model_copy(update={"hooks": _hooks_of_the_file(loaded.path)})
        )
    walked = meta.get(WALK)
    procedure = load_procedure(str(meta["procedure"] if walked is None else walked["procedure"]))
    params = _params(path.name, procedure, meta["params"])
    bench = procedure.equipped(system_of(bench_of(loaded.cell)).aimed(meta["aimed"]), params)
    plan = procedure.plan(bench, params)
    if plan_digest(plan) != meta["plan_sha256"]:
        raise UsageError(
            f"{path.name} was planned by catseye {writer_of(meta)} and this program plans it differently: its steps "
            "would not fit together; go on with that version, or start a new run; the points so far stay usable"
        )
    planned = PlannedRun(
        loaded,
        procedure,
        params,
        bench,
        plan,
        str(meta["aim"]),
        meta["aimed"]["simulated"],
        resume=path,
        clock_speed=float(meta["clock_speed"]),
        relinked=changed is not None,
    )
    return planned if walked is None else as_walk(planned, root, own_legs(path))


def _require_resumable(reader: RunReader) -> None:
    if text := why_not_resumable(reader):
        raise UsageError(text)


def _require_whole(reader: RunReader) -> None:
    """Check every stored row, also of those tables that only the run itself looks into when it goes on."""
    if texts := reader.misfits():
        raise StorageError(
            f"{reader.path.name} is damaged and cannot go on: {texts[0]}; catseye verify says more; start a new run"
        )


def _configured(reader: RunReader, meta: Mapping[str, Any]) -> LoadedCell:
    """Return the cell as it was resolved last: a run that went on with other endpoints keeps them."""
    reopened = [e.data["configuration"] for e in reader.events() if e.data.get("configuration")]
    values = reopened[-1] if reopened else meta["configuration"]
    try:
        cell = Cell.model_validate_json(json.dumps(values))
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        raise UsageError(
            f"{reader.path.name}: its configuration, of catseye {writer_of(meta)}, does not fit this program "
            f"({key}: {first['msg']}): go on with that version, or start a new run"
        ) from error
    origins = dict(meta.get("configuration_origins") or {})
    return LoadedCell(
        cell, Path(str(meta["configuration_file"])), str(meta.get("configuration_sha256", "")), origins
    )


def _hooks_of_the_file(path: Path) -> Hooks:
    """Return the commands that the run's cell file names now; none if it is gone, and never those of a record."""
    try:
        return load_cell(path).cell.hooks
    except ConfigError:
        return Hooks()


def _params(name: str, procedure: Runnable, values: Any) -> Any:
    try:
        return procedure.params_type.model_validate_json(json.dumps(values))
    except ValidationError as error:
        raise UsageError(
            f"{name}: its parameters do not fit this program's {procedure.name} ({error.errors()[0]['msg']}): go on "
            "with the version that wrote it, or start a new run"
        ) from error


def _require_same_but_links(name: str, stored: Cell, given: Cell) -> None:
    """Check that only the ways to the devices differ.

    Raises:
        UsageError: other keys differ.
    """
    before, after = (flattened(stored_cell(cell)) for cell in (stored, given))
    keys = [key for key in {**before, **after} if before.get(key) != after.get(key) and not _is_link(key)]
    if keys:
        raise UsageError(
            f"{name} cannot go on with this cell file: only endpoints and time-outs may change, and these differ: "
            f"{', '.join(sorted(keys))}; set them as they were, or start a new run"
        )


def _is_link(key: str) -> bool:
    last = key.rpartition(".")[2]
    return last.endswith(("endpoint", "timeout_s"))
