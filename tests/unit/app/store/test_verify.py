"""Damage of every kind is found."""

import errno
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest

from catseye.app.store import soundness
from catseye.app.store.lock import RunLock
from catseye.app.store.run_store import RunStore
from catseye.app.store.seal import MANIFEST, PROMISED, seal, unseal
from catseye.app.store.verify import verify
from tests.unit.app.store.fakes import RECORDS, SEARCH_ROW, TickingClock


@pytest.fixture
async def run(tmp_path: Path) -> Path:
    store = await RunStore.create(tmp_path, "search", {}, TickingClock(), records=RECORDS, reserve_bytes=0)
    await store.append_step("s1", 1, "first", {}, [("search", SEARCH_ROW)] * 3)
    await store.finish("complete", 0)
    return store.path


def tamper(run: Path, *statements: str) -> None:
    (run / "run.sqlite").chmod(0o644)
    with closing(sqlite3.connect(run / "run.sqlite", isolation_level=None)) as connection:
        for statement in statements:
            connection.execute(statement)


async def test_a_sound_run(run: Path) -> None:
    assert verify(run).problems == ()
    assert verify(run).status == "complete"


async def test_a_changed_file(run: Path) -> None:
    (run / "wire.log").chmod(0o644)
    (run / "wire.log").write_text("nothing happened")
    assert verify(run).problems == ("wire.log was changed after the end",)


async def test_missing_and_added_files(run: Path) -> None:
    (run / "app.log").rename(run / "other.log")
    assert verify(run).problems == ("app.log is missing", "other.log was added after the end")


async def test_a_name_of_an_added_file_commands_no_terminal(run: Path) -> None:
    (run / "a\x1b[2J\nP1,0").touch()
    assert verify(run).problems == (r"a\x1b[2J\nP1,0 was added after the end",)


@pytest.mark.parametrize("log", ["wire.log", "app.log"])
async def test_a_log_lost_before_the_end_is_noted(tmp_path: Path, log: str) -> None:
    store = await RunStore.create(tmp_path, "search", {}, TickingClock(), records=RECORDS, reserve_bytes=0)
    (store.path / log).unlink()
    await store.finish("complete", 0)
    found = verify(store.path)
    assert found.ok
    assert found.notes == (
        f"{log} is not sealed with the run: at its end there was none, or no plain file, at that name",
    )


async def test_a_damaged_manifest(run: Path) -> None:
    (run / MANIFEST).chmod(0o644)
    (run / MANIFEST).write_text("{}")
    assert "manifest.json is damaged" in verify(run).problems[0]


async def test_a_run_that_was_not_sealed(run: Path) -> None:
    unseal(run)
    result = verify(run)
    assert result.ok
    assert "not sealed" in result.notes[0]


async def test_a_removed_manifest(run: Path) -> None:
    (run / MANIFEST).unlink()
    assert verify(run).problems == ("manifest.json is missing",)


@pytest.mark.parametrize(
    ("statement", "text"),
    [
        ("DELETE FROM search WHERE seq = 2", "search: row 2 of step s1 is missing"),
        ("DELETE FROM search WHERE seq = 3", "step s1 does not have all of its rows"),
        ("DELETE FROM steps", "search: rows of step s1, which is not done"),
        ("DELETE FROM events WHERE seq = 1", "events: numbers are missing"),
    ],
)
async def test_missing_rows(run: Path, statement: str, text: str) -> None:
    table = statement.split()[2]
    tamper(run, f"DROP TRIGGER {table}_no_delete", statement)
    problems = verify(run).problems
    assert "run.sqlite was changed after the end" in problems
    assert text in problems


async def closed_unsealed(root: Path) -> Path:
    store = await RunStore.create(root, "search", {}, TickingClock(), records=RECORDS, reserve_bytes=0)
    await store.event("run-ended", {"status": "complete", "exit_code": 0, PROMISED: True})
    await store.abandon()
    return store.path


async def test_a_run_sealed_during_the_look_has_lost_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = await closed_unsealed(tmp_path)

    def sealed_meanwhile(directory: Path) -> bool:
        seal(directory, "2026-01-02T00:00:00+00:00")
        return False

    monkeypatch.setattr(soundness, "is_marked_unsealed", sealed_meanwhile)
    found = verify(path)
    assert (found.sealed, found.problems, found.notes) == (True, (), ())


async def test_a_run_just_being_sealed_is_noted_as_such(tmp_path: Path) -> None:
    path = await closed_unsealed(tmp_path)
    lock = RunLock(path)
    try:
        assert verify(path).notes == ("not sealed: it is under way",)
    finally:
        lock.release()
    assert "between the closing record" in verify(path).notes[0]


async def test_a_file_that_cannot_be_read_is_a_problem(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_directory: Path) -> None:
        raise PermissionError(errno.EACCES, "Permission denied", "wire.log")

    monkeypatch.setattr(soundness, "digest", refuse)
    assert "Permission denied: 'wire.log'" in verify(run).problems[0]
