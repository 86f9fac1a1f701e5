"""A run goes on only in files of its own: what a link in its folder leads to belongs to somebody else."""

import os
from pathlib import Path

import pytest

from catseye.app.errors import StorageError
from catseye.app.store.lines import JsonLines
from catseye.app.store.run_store import RunStore
from catseye.app.store.seal import MANIFEST, is_marked_unsealed
from tests.unit.app.store.fakes import RECORDS, TickingClock


async def _ended(folder: Path) -> Path:
    store = await RunStore.create(folder, "search", {}, TickingClock(), records=RECORDS, reserve_bytes=0)
    await store.finish("stopped", 130)
    return store.path


async def _go_on(run: Path) -> None:
    store = await RunStore.reopen(run, TickingClock(), records=RECORDS, reserve_bytes=0)
    await store.abandon()


@pytest.mark.parametrize("name", ["run.sqlite", "run.sqlite-wal", "run.sqlite-shm", "wire.log", "app.log"])
async def test_a_link_in_a_run_is_not_written_through(tmp_path: Path, name: str) -> None:
    run, other = await _ended(tmp_path / "runs"), tmp_path / "other"
    if (run / name).exists():
        (run / name).rename(other)
    else:
        other.write_bytes(b"")
    before = other.read_bytes()
    (run / name).symlink_to(other)
    with pytest.raises(StorageError, match=rf"{name} is a link, .*remove it"):
        await _go_on(run)
    assert other.read_bytes() == before
    # What is refused stays as it was.
    assert (run / MANIFEST).is_file()
    assert not is_marked_unsealed(run)


async def test_a_pipe_in_place_of_a_log_is_refused(tmp_path: Path) -> None:
    run = await _ended(tmp_path)
    (run / "wire.log").unlink()
    os.mkfifo(run / "wire.log")
    with pytest.raises(StorageError, match=r"wire\.log is no regular file"):
        await _go_on(run)


def test_a_log_is_never_opened_through_a_link(tmp_path: Path) -> None:
    failures: list[OSError] = []
    (tmp_path / "app.log").symlink_to(tmp_path / "other")
    with pytest.raises(OSError, match=r"app\.log"):
        JsonLines(tmp_path / "app.log", TickingClock(), failures.append)
    assert not (tmp_path / "other").exists()
