"""The promise of the store, line by line."""

import errno
import fcntl
import json
import os
import shutil
import sqlite3
import stat
import threading
from collections.abc import AsyncIterator
from contextlib import closing
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from typing import ClassVar

import pytest

from catseye.app.errors import StorageError, UsageError
from catseye.app.store import lines, seal
from catseye.app.store.catalog import list_runs
from catseye.app.store.lock import RunLock, is_being_written
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.app.store.schema import BASE_TABLES, CHUNKS, VERSION, open_reader, open_writer
from catseye.app.store.seal import MANIFEST
from catseye.app.store.verify import verify
from catseye.procedures.kit.records import Column, Record, Table, tables_of
from tests.unit.app.engine.fakes import point
from tests.unit.app.store.fakes import PATH_ROW, RECORDS, SEARCH_ROW, TickingClock


@pytest.fixture
async def store(tmp_path: Path) -> AsyncIterator[RunStore]:
    made = await RunStore.create(
        tmp_path, "search", {"operator": "Ada"}, TickingClock(), records=RECORDS, reserve_bytes=0
    )
    yield made
    await made.abandon()


def writer_of(store: RunStore) -> "closing[sqlite3.Connection]":
    """Return a foreign read-write connection, as somebody with a database tool would open."""
    return closing(sqlite3.connect(store.path / "run.sqlite", isolation_level=None))


async def test_the_name_contains_time_procedure_and_id(store: RunStore) -> None:
    time, procedure, run_id = store.path.name.split("_")
    assert (time, procedure, len(run_id)) == ("20260102T000001Z", "search", 6)


async def test_p1_what_is_acknowledged_is_there_for_every_reader(store: RunStore) -> None:
    await store.append_step("s1", 1, "first", {"found": True}, [("search", SEARCH_ROW)])
    reader = RunReader(store.path)
    assert reader.steps()[0].result == {"found": True}
    assert reader.rows("search")[0]["reflector"] == "P1"
    assert store.stored_result("s1") == {"found": True}
    assert store.stored_result("s2") is None


async def test_p2_a_step_and_its_rows_are_atomic(store: RunStore) -> None:
    # The second row collides inside the transaction, after the step and the first row were inserted.
    await store.append_step("s1", 1, "first", {}, [("search", SEARCH_ROW)])
    with pytest.raises(StorageError):
        await store.append_step("s1", 1, "again", {}, [("path", PATH_ROW)])
    reader = RunReader(store.path)
    assert [step.title for step in reader.steps()] == ["first"]
    assert reader.rows("path") == []


async def test_p2_an_invalid_row_stores_nothing_and_harms_nothing(store: RunStore) -> None:
    with pytest.raises(ValueError, match="lacks reflector"):
        await store.append_step("s1", 1, "first", {}, [("search", {"theta1_deg": 1.0, "theta2_deg": 2.0})])
    await store.append_step("s1", 1, "first", {}, [])
    assert RunReader(store.path).count("steps") == 1


async def test_p3_lines_cut_from_the_transcript_are_counted(tmp_path: Path) -> None:
    clock = TickingClock()
    store = await RunStore.create(
        tmp_path, "search", {}, clock, records=RECORDS, reserve_bytes=0, max_log_bytes=300
    )
    for _ in range(5):
        store.wire.record("stream", "rx", b"\x00QoK")
    # A device that fills its half of the transcript does not push the others out.
    store.wire.record("robot", "tx", b"STOP")
    await store.finish("complete", 0)
    written = [json.loads(line) for line in (store.path / "wire.log").read_text().splitlines()]
    assert [line["device"] for line in written] == ["stream", "robot"]
    closing_record = RunReader(store.path).events()[-1].data
    assert closing_record["wire_lines_cut"] == 4
    assert verify(store.path).notes == ("wire.log was cut: 4 lines are not in it",)


async def test_the_closing_record_counts_healings_by_device(store: RunStore) -> None:
    store.wire.record("robot", "tx", b"1;1;STATE")
    for device in ("robot", "interferometer", "robot"):
        store.wire.record(device, "heal", b"no answer")
    await store.finish("stopped", 5)
    store = await RunStore.reopen(store.path, TickingClock())
    store.wire.record("robot", "heal", b"no answer")
    await store.finish("complete", 0)
    assert RunReader(store.path).heals() == {"robot": 3, "interferometer": 1}


async def test_p4_after_one_failure_everything_is_refused(store: RunStore) -> None:
    failures: list[StorageError] = []
    store.on_failure = failures.append
    await store.append_step("s1", 1, "first", {}, [])
    with pytest.raises(StorageError, match="nothing more is stored"):
        await store.append_step("s1", 1, "again", {}, [])
    with pytest.raises(StorageError):
        await store.event("note")
    with pytest.raises(StorageError):
        await store.append_step("s2", 1, "second", {}, [])
    store.post("note", {})
    with pytest.raises(StorageError):
        await store.finish("complete", 0)
    assert RunReader(store.path).status == "died"
    assert len(failures) == 1


async def test_p4_logging_to_a_full_disk_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    store = await RunStore.create(tmp_path, "search", {}, TickingClock(), records=RECORDS, reserve_bytes=0)
    await store.finish("stopped", 130)
    monkeypatch.setattr(lines, "_opened", lambda _path: FileIO("/dev/full", "ab"))
    store = await RunStore.reopen(store.path, TickingClock(), records=RECORDS, reserve_bytes=0)
    store.wire.record("robot", "tx", b"x")
    with pytest.raises(StorageError, match="No space left"):
        await store.event("note")
    await store.abandon()


@pytest.mark.parametrize("name", ["run.sqlite", "run.sqlite-wal"])
@pytest.mark.parametrize("replaced", [False, True])
async def test_p4_nothing_is_acknowledged_in_a_file_that_is_gone(
    store: RunStore, name: str, replaced: bool
) -> None:
    failures: list[StorageError] = []
    store.on_failure = failures.append
    await store.append_step("s1", 1, "first", {}, [])
    if replaced:
        shutil.copy(store.path / name, store.path / "copy")
        (store.path / "copy").rename(store.path / name)
    else:
        (store.path / name).unlink()
    with pytest.raises(StorageError, match=name):
        await store.append_step("s2", 1, "second", {}, [])
    with pytest.raises(StorageError, match="nothing more is stored"):
        await store.finish("complete", 0)
    assert seal.read_manifest(store.path) is None
    assert len(failures) == 1


async def test_p4_no_run_begins_without_a_reserve(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match="make room"):
        await RunStore.create(tmp_path, "search", {}, TickingClock(), reserve_bytes=1 << 60)
    assert list_runs(tmp_path) == []


async def test_p4_a_run_fails_before_the_disk_is_full(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("catseye.app.store.new_run.shutil.disk_usage", lambda _path: Usage())
    monkeypatch.setattr(store, "_reserve_bytes", 1000)
    with pytest.raises(StorageError, match="make room"):
        await store.append_step("s1", 1, "first", {}, [])
    with pytest.raises(StorageError):
        await store.event("note")


class Usage:
    free = 99


@pytest.mark.parametrize("table", [*BASE_TABLES, *(table.name for table in tables_of(RECORDS))])
@pytest.mark.parametrize("verb", ["UPDATE {} SET rowid = 99", "DELETE FROM {}"])
async def test_p5_nothing_is_overwritten(store: RunStore, table: str, verb: str) -> None:
    await store.append_step("s1", 1, "first", {}, [("search", SEARCH_ROW), ("path", PATH_ROW)])
    await store.append_step("s2", 1, "second", {}, [("points", point()), ("records", {"kind": "drift"})])
    await store.prompt("clear", "confirm", "Clear?", "2026-01-02T00:00:00+00:00", "yes", "Ada")
    with writer_of(store) as connection, pytest.raises(sqlite3.IntegrityError, match="append-only"):
        connection.execute(verb.format(table))


async def test_p6_the_run_describes_itself(store: RunStore) -> None:
    meta = RunReader(store.path).meta
    assert (meta["operator"], meta["procedure"], meta["run"]) == ("Ada", "search", store.path.name)
    software = meta["software"]
    assert isinstance(software, dict)
    assert {"catseye", "python", "sqlite", "numpy", "platform"} <= set(software)
    anchor = meta["clock_anchor"]
    assert isinstance(anchor, dict)
    assert set(anchor) == {"utc", "monotonic_s"}


async def test_p6_prompts_and_interruptions_are_kept(store: RunStore) -> None:
    await store.prompt("clear", "confirm", "Clear?", "2026-01-02T00:00:00+00:00", "yes", "Ada")
    await store.prompt("name", "text", "Name?", "2026-01-02T00:00:00+00:00", None, None)
    store.post("state", {"state": "HELD"})
    await store.event("state", {"state": "EXECUTE"})
    reader = RunReader(store.path)
    assert [prompt["answered_utc"] is None for prompt in reader.prompts()] == [False, True]
    assert [event.data["state"] for event in reader.events()[1:]] == ["HELD", "EXECUTE"]


async def test_a_finished_run_is_read_only_with_a_manifest(store: RunStore) -> None:
    await store.finish("complete", 0)
    names = sorted(path.name for path in store.path.iterdir())
    assert names == ["app.log", "manifest.json", "run.sqlite", "wire.log"]
    assert not any(path.stat().st_mode & stat.S_IWUSR for path in store.path.iterdir())
    assert set(json.loads((store.path / MANIFEST).read_text())["files"]) == set(names) - {MANIFEST}
    with closing(open_reader(store.path / "run.sqlite")) as connection:
        assert connection.execute("PRAGMA journal_mode").fetchone()[0] == "delete"
    assert verify(store.path).ok


async def test_a_concurrent_reader_does_not_prevent_finishing(store: RunStore) -> None:
    with closing(open_reader(store.path / "run.sqlite")) as connection:
        connection.execute("BEGIN")
        connection.execute("SELECT count(*) FROM events").fetchall()
        await store.event("note")
        await store.finish("complete", 0)
    assert RunReader(store.path).events()[-1].kind == "run-ended"
    assert verify(store.path).ok


async def test_status_follows_the_life_of_a_run(store: RunStore) -> None:
    reader = RunReader(store.path)
    seen = [(reader.status, reader.exit_code)]
    await store.abandon()
    seen.append((reader.status, reader.exit_code))
    again = await RunStore.reopen(store.path, TickingClock(), records=RECORDS, reserve_bytes=0)
    seen.append((reader.status, reader.exit_code))
    await again.finish("stopped", 130)
    seen.append((reader.status, reader.exit_code))
    assert seen == [("running", None), ("died", None), ("running", None), ("stopped", 130)]


async def test_a_reopened_run_knows_results_and_attempts(store: RunStore) -> None:
    await store.append_step("s1", 1, "first", {"n": 1}, [])
    await store.drop_step("s2", 1, {"error": "lost"})
    await store.abandon()
    again = await RunStore.reopen(store.path, TickingClock(), records=RECORDS, reserve_bytes=0)
    assert again.stored_result("s1") == {"n": 1}
    assert again.next_attempt("s2") == 2
    await again.append_step("s2", 2, "second", {}, [("search", SEARCH_ROW)])
    await again.finish("complete", 0)
    assert verify(store.path).ok
    assert verify(store.path).notes == ("an attempt at step s2 was dropped: lost",)


async def test_two_processes_never_write_one_run(store: RunStore) -> None:
    with pytest.raises(StorageError, match="being written"):
        await RunStore.reopen(store.path, TickingClock(), records=RECORDS, reserve_bytes=0)


async def test_checking_for_a_writer_does_not_block_it(store: RunStore) -> None:
    await store.abandon()
    looking = os.open(store.path, os.O_RDONLY)
    fcntl.flock(looking, fcntl.LOCK_SH)
    release = threading.Timer(0.01, os.close, (looking,))
    release.start()
    lock = RunLock(store.path)
    assert is_being_written(store.path)
    lock.release()
    release.join()


async def test_a_run_that_is_just_being_sealed_is_left_alone(store: RunStore) -> None:
    await store.finish("stopped", 4)
    lock = RunLock(store.path)
    try:
        with pytest.raises(StorageError, match="being written"):
            await RunStore.reopen(store.path, TickingClock(), records=RECORDS, reserve_bytes=0)
    finally:
        lock.release()
    assert seal.read_manifest(store.path) is not None


async def test_a_stopped_run_of_somebody_else_is_not_reopened(
    store: RunStore, monkeypatch: pytest.MonkeyPatch
) -> None:
    await store.finish("stopped", 130)

    def refuse(*_: object) -> None:
        raise PermissionError(errno.EPERM, "Operation not permitted")

    monkeypatch.setattr(os, "fchmod", refuse)
    with pytest.raises(StorageError, match=str(store.path)):
        await RunStore.reopen(store.path, TickingClock(), records=RECORDS, reserve_bytes=0)
    assert verify(store.path).problems == verify(store.path).notes == ()


async def test_a_folder_that_cannot_be_locked_is_named(tmp_path: Path) -> None:
    for lock in (RunLock, is_being_written):
        with pytest.raises(StorageError, match=str(tmp_path / "nowhere")):
            lock(tmp_path / "nowhere")


async def test_a_complete_run_is_not_reopened(store: RunStore) -> None:
    await store.finish("complete", 0)
    with pytest.raises(UsageError, match="start a new run"):
        await RunStore.reopen(store.path, TickingClock(), records=RECORDS, reserve_bytes=0)


async def test_a_closed_store_refuses(store: RunStore) -> None:
    await store.finish("complete", 0)
    with pytest.raises(StorageError, match="is closed"):
        await store.event("late")


def test_commits_are_durable_and_the_version_is_known(tmp_path: Path) -> None:
    with closing(open_writer(tmp_path / "run.sqlite")) as connection:
        assert connection.execute("PRAGMA synchronous").fetchone()[0] == 2
        assert connection.execute("PRAGMA journal_mode").fetchone()[0] == "wal"
        assert connection.execute("PRAGMA user_version").fetchone()[0] == VERSION
        strict = connection.execute("SELECT name FROM pragma_table_list WHERE strict = 1").fetchall()
    assert {name for (name,) in strict} == {*BASE_TABLES, CHUNKS}


def test_a_newer_file_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.sqlite"
    with closing(open_writer(path)) as connection:
        connection.execute(f"PRAGMA user_version={VERSION + 1}")
    for opener in (open_writer, open_reader):
        with pytest.raises(StorageError, match="install a newer catseye"):
            opener(path)


def test_what_is_no_run_is_said(tmp_path: Path) -> None:
    with pytest.raises(StorageError, match="not a run"):
        RunReader(tmp_path)
    (tmp_path / "run.sqlite").write_bytes(b"this is no database" * 100)
    with pytest.raises(StorageError, match="cannot be read"):
        RunReader(tmp_path)
    (tmp_path / "run.sqlite").write_bytes(b"")
    with pytest.raises(StorageError, match="no tables"):
        RunReader(tmp_path)


async def test_a_place_without_permission_is_said() -> None:
    with pytest.raises(StorageError, match="choose another directory"):
        await RunStore.create(
            Path("/proc/nowhere"), "search", {}, TickingClock(), records=RECORDS, reserve_bytes=0
        )


async def test_minus_zero_is_read_back(store: RunStore) -> None:
    # A controller reports "-0.00", and SQLite keeps no sign of zero: the check sum is of what comes back.
    await store.append_step("s1", 1, "first", {}, [("search", {**SEARCH_ROW, "theta1_deg": -0.0})])
    assert RunReader(store.path).rows("search")[0]["theta1_deg"] == 0.0


async def test_a_path_not_in_utf_8_round_trips(tmp_path: Path) -> None:
    root = tmp_path / os.fsdecode(b"lab\xff")
    cell = str(root / "cell.toml")
    made = await RunStore.create(
        root, "search", {"cell": cell}, TickingClock(), records=RECORDS, reserve_bytes=0
    )
    await made.event("warning", {"text": cell})
    await made.finish("complete", 0)
    reader = RunReader(made.path)
    assert reader.meta["cell"] == cell
    assert reader.events()[1].data == {"text": cell}
    assert verify(made.path).ok


@dataclass(frozen=True, kw_only=True)
class _Choice(Record):
    """Its table and columns are words of SQL."""

    table: ClassVar[str] = "group"
    index: int
    order: float
    limit: str | None = None


async def test_names_that_are_words_of_sql_are_stored(tmp_path: Path) -> None:
    made = await RunStore.create(tmp_path, "spiral", {}, TickingClock(), records=[_Choice], reserve_bytes=0)
    await made.append_step("s1", 1, "first", {}, [("group", {"index": 3, "order": 1.5})])
    await made.finish("stopped", 5)
    reader = RunReader(made.path)
    assert (reader.count("group"), reader.rows("group")[0]["order"]) == (1, 1.5)
    assert verify(made.path).problems == ()


@pytest.mark.parametrize("name", ["place", "rowid", "oid", "extra"])
def test_a_column_that_reading_would_hide_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="choose other names"):
        Table("samples", (Column(name, "REAL", required=True),))


async def test_a_run_with_other_columns_stays_sealed(store: RunStore) -> None:
    await store.finish("stopped", 5)
    before = (store.path / MANIFEST).read_bytes()

    @dataclass(frozen=True, kw_only=True)
    class Seen(Record):
        table: ClassVar[str] = "search"
        reflector: str

    with pytest.raises(StorageError, match="table search has other columns"):
        await RunStore.reopen(store.path, TickingClock(), records=[Seen], reserve_bytes=0)
    assert (store.path / MANIFEST).read_bytes() == before
    assert verify(store.path).sealed
