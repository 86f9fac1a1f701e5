"""A run that was changed after its end is not opened without a word."""

import errno
import os
import shutil
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from catseye.app.errors import StorageError
from catseye.app.store import soundness
from catseye.app.store.catalog import list_runs
from catseye.app.store.mend import seal_late
from catseye.app.store.reader import Accept, RunReader
from catseye.app.store.run_store import RunStore
from catseye.app.store.schema import BASE_TABLES
from catseye.app.store.seal import MANIFEST, UNSEALED, digest, unseal
from catseye.app.store.verify import verify
from tests.unit.app.store.fakes import RECORDS, SEARCH_ROW, TickingClock

CHANGED = "run.sqlite was changed after the end"


async def stored(root: Path, status: str | None = "complete") -> Path:
    store = await RunStore.create(root, "search", {}, TickingClock(), records=RECORDS, reserve_bytes=0)
    await store.append_step("s1", 1, "first", {}, [("search", SEARCH_ROW)] * 3)
    await (store.abandon() if status is None else store.finish(status, 0))
    return store.path


def tamper(run: Path, *statements: str) -> None:
    (run / "run.sqlite").chmod(0o644)
    with closing(sqlite3.connect(run / "run.sqlite", isolation_level=None)) as connection:
        for table in (*BASE_TABLES, "search"):
            for verb in ("update", "delete"):
                connection.execute(f"DROP TRIGGER IF EXISTS {table}_no_{verb}")
        for statement in statements:
            connection.execute(statement)


TURNED = "UPDATE search SET theta1_deg = 1.5 WHERE seq = 2"


async def test_a_changed_sealed_run_is_refused(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    tamper(run, TURNED)
    with pytest.raises(StorageError, match=CHANGED) as refusal:
        RunReader(run)
    assert "--unverified" in str(refusal.value)
    assert run.name in str(refusal.value)


async def test_a_changed_run_is_taken_on_demand(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    tamper(run, TURNED)
    reader = RunReader(run, Accept.CHANGED)
    assert reader.rows("search")[1]["theta1_deg"] == 1.5
    assert reader.unverified == [f"{run.name}: {CHANGED}"]


async def test_a_sound_run_taken_unverified_has_nothing_against_it(tmp_path: Path) -> None:
    assert RunReader(await stored(tmp_path), Accept.CHANGED).unverified == []


async def test_runs_opened_beside_one_are_listed_with_it(tmp_path: Path) -> None:
    first, second, third = [await stored(tmp_path) for _ in range(3)]
    tamper(third, TURNED)
    reader = RunReader(first, Accept.CHANGED)
    reader.beside(second).beside(third)
    assert reader.unverified == [f"{third.name}: {CHANGED}"]
    with pytest.raises(StorageError, match=third.name):
        RunReader(first).beside(third)


async def test_a_damaged_manifest_is_refused(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    (run / MANIFEST).chmod(0o644)
    (run / MANIFEST).write_text("{}")
    with pytest.raises(StorageError, match=r"manifest\.json is damaged"):
        RunReader(run)


async def test_a_sealed_run_without_its_manifest_is_refused(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    (run / MANIFEST).unlink()
    with pytest.raises(StorageError, match=r"manifest\.json is missing") as refusal:
        RunReader(run)
    assert "--unverified" in str(refusal.value)
    assert run.name in str(refusal.value)


async def test_a_run_without_its_manifest_is_taken_on_demand(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    (run / MANIFEST).unlink()
    reader = RunReader(run, Accept.CHANGED)
    assert len(reader.rows("search")) == 3
    assert reader.unverified == [f"{run.name}: manifest.json is missing"]


async def test_a_database_moved_out_of_its_run_is_refused(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    (tmp_path / "elsewhere").mkdir()
    shutil.copy(run / "run.sqlite", tmp_path / "elsewhere")
    with pytest.raises(StorageError, match=r"elsewhere .*manifest\.json is missing"):
        RunReader(tmp_path / "elsewhere")


async def test_a_removed_manifest_is_not_made_anew(tmp_path: Path) -> None:
    run = await stored(tmp_path)
    (run / MANIFEST).unlink()
    with pytest.raises(StorageError, match=r"manifest\.json is missing"):
        seal_late(run, "2026-01-02T00:00:00+00:00")
    assert not (run / MANIFEST).exists()


async def test_a_run_that_died_while_resuming_is_readable(tmp_path: Path) -> None:
    run = await stored(tmp_path, "stopped")
    unseal(run)
    assert RunReader(run).status == "stopped"


async def test_a_run_closed_by_an_older_program_is_taken(tmp_path: Path) -> None:
    # It promised no manifest in its closing record, and had no file that stood for one.
    store = await RunStore.create(tmp_path, "search", {}, TickingClock(), records=RECORDS, reserve_bytes=0)
    await store.event("run-ended", {"status": "complete", "exit_code": 0})
    await store.abandon()
    (store.path / UNSEALED).unlink()
    assert RunReader(store.path).status == "complete"
    assert verify(store.path).ok


async def test_a_changed_row_of_an_unsealed_run_is_refused(tmp_path: Path) -> None:
    run = await stored(tmp_path, None)
    tamper(run, TURNED)
    with pytest.raises(StorageError, match="row 2 of search is not what was written"):
        RunReader(run).rows("search")
    assert any("row 2 of search" in problem for problem in verify(run).problems)


async def test_a_missing_last_row_of_an_unsealed_run_is_refused(tmp_path: Path) -> None:
    run = await stored(tmp_path, None)
    tamper(run, "DELETE FROM search WHERE seq = 3")
    with pytest.raises(StorageError, match="row 3 of search is missing"):
        RunReader(run).rows("search")


async def test_a_row_without_an_entry_in_the_journal_is_refused(tmp_path: Path) -> None:
    run = await stored(tmp_path, None)
    tamper(run, "DELETE FROM journal WHERE of = 'search' AND row = 2")
    with pytest.raises(StorageError, match="row 2 of search has no entry in the journal"):
        RunReader(run).rows("search")


async def test_a_journal_whose_numbers_are_none_is_refused(tmp_path: Path) -> None:
    run = await stored(tmp_path, None)
    copied = ("CREATE TABLE copy AS SELECT * FROM journal", "DROP TABLE journal")
    renamed = ("ALTER TABLE copy RENAME TO journal", "INSERT INTO journal VALUES (99, 'search', 'x', 1)")
    tamper(run, *copied, *renamed)
    with pytest.raises(StorageError, match=r"is damaged: a stored value cannot be read"):
        RunReader(run).rows("search")
    assert any("a stored value cannot be read" in problem for problem in verify(run).problems)


async def test_a_list_of_runs_reads_no_file_whole(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = await stored(tmp_path)
    monkeypatch.setattr("catseye.app.store.soundness.digest", lambda _directory: pytest.fail("hashed"))
    assert [found.status for found in list_runs(tmp_path)] == ["complete"]
    assert RunReader(run, Accept.UNCHECKED).status == "complete"


async def test_files_are_hashed_once_until_they_change(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run, hashed = await stored(tmp_path), []

    def counted(directory: Path) -> object:
        hashed.append(directory)
        return digest(directory)

    monkeypatch.setattr(soundness, "digest", counted)
    for _ in range(3):
        RunReader(run).rows("search")
    assert len(hashed) == 1
    tamper(run, TURNED)
    with pytest.raises(StorageError):
        RunReader(run)
    assert len(hashed) == 2


async def test_a_run_resumed_while_being_checked_counts_as_unchanged(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    run = await stored(tmp_path, "stopped")

    def reopened_meanwhile(directory: Path) -> object:
        unseal(directory)
        return {}

    monkeypatch.setattr(soundness, "digest", reopened_meanwhile)
    assert RunReader(run).status == "stopped"


async def test_a_run_that_cannot_be_sealed_late_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    store = await RunStore.create(tmp_path, "search", {}, TickingClock(), records=RECORDS, reserve_bytes=0)
    await store.event("run-ended", {"status": "complete", "exit_code": 0})
    await store.abandon()

    def refuse(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, "fsync", refuse)
    with pytest.raises(StorageError, match=f"{store.path}.*No space left"):
        seal_late(store.path, "2026-01-02T00:00:00+00:00")
