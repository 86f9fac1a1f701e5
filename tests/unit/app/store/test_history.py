"""The history of runs: what a line says, and that only what changed is read anew."""

import os
import sqlite3
from contextlib import closing
from datetime import UTC, datetime
from pathlib import Path

import pytest

from catseye.app.store import history as module
from catseye.app.store.history import RunHistory
from catseye.app.store.lock import RunLock
from catseye.app.store.run_store import RunStore
from catseye.app.store.schema import open_reader
from catseye.app.store.seal import DATABASE
from tests.unit.app.store.fakes import TickingClock


async def make_run(root: Path, clock: TickingClock, status: str | None = "complete") -> RunStore:
    store = await RunStore.create(
        root, "open-loop", {"cell": "lab-1", "simulated": True}, clock, reserve_bytes=0
    )
    if status == "complete":
        await store.finish("complete", 0)
    elif status == "stopped":
        await store.finish("stopped", 5)
    return store


async def test_a_line_says_how_a_run_ended(tmp_path: Path) -> None:
    clock = TickingClock()
    stores = [await make_run(tmp_path, clock, status) for status in ("complete", "stopped", None)]
    damaged = tmp_path / "20270101T000000Z_warm-up_abcdef"
    damaged.mkdir()
    (damaged / DATABASE).write_bytes(b"no database at all, but long enough to look like one")
    (tmp_path / "20271399T000000Z_open-loop_abcdef").mkdir()
    (tmp_path / "notes").mkdir()
    history = RunHistory(tmp_path)
    found = list(history.changes())
    assert found == history.lines
    assert [line.status for line in found] == ["damaged", "running", "stopped", "complete"]
    assert [line.path for line in found[:0:-1]] == [store.path for store in stores]
    first = found[-1]
    assert (first.procedure, first.cell, first.simulated, first.rows) == ("open-loop", "lab-1", True, 0)
    assert first.started_utc == datetime(2026, 1, 2, 0, 0, 1, tzinfo=UTC)
    assert "file is not a database" in found[0].fault
    await stores[2].abandon()


async def test_a_fact_of_another_type_is_a_damaged_run(tmp_path: Path) -> None:
    store = await make_run(tmp_path, TickingClock())
    # Sealed: without this nobody but root may write.
    store.path.chmod(0o700)
    (store.path / DATABASE).chmod(0o600)
    with closing(sqlite3.connect(store.path / DATABASE)) as connection, connection:
        connection.execute("DROP TRIGGER events_no_update")
        connection.execute("UPDATE events SET data = '5' WHERE kind = 'run-ended'")
    assert [line.status for line in RunHistory(tmp_path).changes()] == ["damaged"]


async def test_duration_is_from_the_first_record_to_the_last(tmp_path: Path) -> None:
    store = await make_run(tmp_path, TickingClock())
    with closing(sqlite3.connect(store.path / DATABASE)) as connection:
        times = [datetime.fromisoformat(row[0]) for row in connection.execute("SELECT time_utc FROM events")]
    line = next(RunHistory(tmp_path).changes())
    assert line.duration_s == (max(times) - min(times)).total_seconds()


async def test_only_what_changed_is_read_anew(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    clock = TickingClock()
    first, second = await make_run(tmp_path, clock), await make_run(tmp_path, clock)
    opened: list[Path] = []

    def counted(path: Path) -> sqlite3.Connection:
        opened.append(path.parent)
        return open_reader(path)

    monkeypatch.setattr(module, "open_reader", counted)
    history = RunHistory(tmp_path)
    assert len(list(history.changes())) == 2
    opened.clear()
    assert list(history.changes()) == []
    assert opened == []
    os.utime(second.path / DATABASE, ns=(1, 1))
    assert [line.path for line in history.changes()] == [second.path]
    assert opened == [second.path]
    for file in first.path.iterdir():
        file.unlink()
    first.path.rmdir()
    assert list(history.changes()) == []
    assert [line.path for line in history.lines] == [second.path]


async def test_a_writer_that_dies_changes_its_run(tmp_path: Path) -> None:
    store = await make_run(tmp_path, TickingClock(), None)
    history = RunHistory(tmp_path)
    assert [line.status for line in history.changes()] == ["running"]
    await store.abandon()
    assert [line.status for line in history.changes()] == ["died"]
    assert list(history.changes()) == []
    lock = RunLock(store.path)
    assert [line.status for line in history.changes()] == ["running"]
    lock.release()


def test_no_folder_no_runs(tmp_path: Path) -> None:
    assert list(RunHistory(tmp_path / "none").changes()) == []
