"""Finding runs."""

import errno
import os
from pathlib import Path

import pytest

from catseye.app.errors import StorageError, UsageError
from catseye.app.store.catalog import list_runs, resolve_run
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.app.store.seal import DATABASE
from tests.unit.app.store.fakes import TickingClock


@pytest.fixture
async def runs(tmp_path: Path) -> list[Path]:
    paths = []
    clock = TickingClock()
    for procedure in ("reflector-search", "open-loop"):
        store = await RunStore.create(tmp_path, procedure, {}, clock, reserve_bytes=0)
        await store.finish("complete", 0)
        paths.append(store.path)
    return paths


async def test_runs_are_listed_oldest_first(runs: list[Path]) -> None:
    root = runs[0].parent
    (root / "notes").mkdir()
    damaged = root / "20270101T000000Z_open-loop_abcdef"
    damaged.mkdir()
    found = list_runs(root)
    assert [run.path for run in found] == [*runs, damaged]
    assert [run.status for run in found] == ["complete", "complete", "damaged"]
    assert (found[0].procedure, found[0].started) == ("reflector-search", "20260102T000001Z")
    assert found[0].name.endswith(found[0].id)


def unreadable(root: Path) -> Path:
    """Return a run whose database the system refuses to look at, as it does with a folder of somebody else."""
    run = root / "20270101T000000Z_open-loop_abcdef"
    run.mkdir(parents=True)
    (run / DATABASE).symlink_to("n" * 300)
    return run


async def test_an_unreadable_run_leaves_the_others_in_the_list(runs: list[Path]) -> None:
    run = unreadable(runs[0].parent)
    assert [(found.path, found.status) for found in list_runs(run.parent)][-2:] == [
        (runs[-1], "complete"),
        (run, "damaged"),
    ]


def test_an_unreadable_run_is_named(tmp_path: Path) -> None:
    run = unreadable(tmp_path)
    with pytest.raises(StorageError, match=f"{run}.* cannot be read: .*name too long"):
        RunReader(run)
    with pytest.raises(StorageError, match=f"{run}.* cannot be read: .*name too long"):
        resolve_run(tmp_path, str(run))


async def test_a_run_whose_folder_cannot_be_listed_is_named(
    runs: list[Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(folder: Path) -> None:
        raise PermissionError(errno.EACCES, "Permission denied", str(folder))

    monkeypatch.setattr(os, "scandir", refuse)
    with pytest.raises(StorageError, match=f"{runs[0].name}.*Permission denied"):
        RunReader(runs[0])


def test_a_folder_of_runs_that_cannot_be_listed_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def refuse(folder: Path) -> None:
        raise PermissionError(errno.EACCES, "Permission denied", str(folder))

    monkeypatch.setattr(Path, "iterdir", refuse)
    with pytest.raises(StorageError, match=f"{tmp_path}.*Permission denied"):
        list_runs(tmp_path)


def test_a_place_without_runs_lists_none(tmp_path: Path) -> None:
    assert list_runs(tmp_path / "nowhere") == []


async def test_a_run_is_found_by_path_name_beginning_and_id(runs: list[Path]) -> None:
    root, wanted = runs[0].parent, runs[0]
    for text in (str(wanted), wanted.name, wanted.name[:17], wanted.name[-6:]):
        assert resolve_run(root, text) == wanted


async def test_a_beginning_that_fits_several_lists_them(runs: list[Path]) -> None:
    with pytest.raises(UsageError, match=f"{runs[0].name}, {runs[1].name}"):
        resolve_run(runs[0].parent, "2026")


async def test_a_typing_error_names_the_nearest(runs: list[Path]) -> None:
    name = runs[0].name
    with pytest.raises(UsageError, match=f"nearest are .*{name}"):
        resolve_run(runs[0].parent, name.replace("search", "saerch"))
    with pytest.raises(UsageError, match=f"the newest is {runs[1].name}"):
        resolve_run(runs[0].parent, "?")


def test_an_empty_place_says_so(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="holds no runs"):
        resolve_run(tmp_path, "abc")
