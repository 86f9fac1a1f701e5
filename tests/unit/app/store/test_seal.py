"""Sealing keeps to the run's own files."""

import contextlib
import errno
import itertools
import os
import pwd
import stat
from collections.abc import Callable
from pathlib import Path

import pytest

from catseye.app.errors import StorageError
from catseye.app.store import seal
from catseye.app.store.seal import MANIFEST
from tests.unit.app.disk_order import recorded

NOW_UTC = "2026-01-02T00:00:00+00:00"


@pytest.fixture
def run(tmp_path: Path) -> Path:
    path = tmp_path / "run"
    path.mkdir()
    (path / "run.sqlite").write_bytes(b"data")
    return path


@pytest.fixture
def outside(tmp_path: Path) -> Path:
    path = tmp_path / "secret"
    path.write_text("secret")
    path.chmod(0o600)
    return path


def mode_of(path: Path) -> int:
    return stat.S_IMODE(path.lstat().st_mode)


def sealed_files(run: Path) -> set[str]:
    manifest = seal.read_manifest(run)
    assert manifest is not None
    return set(manifest.files)


def sealed_files_after(run: Path) -> set[str]:
    seal.seal(run, NOW_UTC)
    return sealed_files(run)


def refuse(*_: object) -> None:
    """Stand for the kernel's answer to somebody whose file it is not."""
    raise PermissionError(errno.EPERM, "Operation not permitted")


def test_a_run_of_somebody_else_keeps_its_manifest(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    seal.seal(run, NOW_UTC)
    before = {path.name: path.read_bytes() for path in run.iterdir()}
    monkeypatch.setattr(os, "fchmod", refuse)
    with pytest.raises(StorageError, match="not permitted") as refusal:
        seal.unseal(run)
    assert {path.name: path.read_bytes() for path in run.iterdir()} == before
    assert f"{run} of {run.owner()}" in str(refusal.value)


def test_an_owner_without_a_name_is_shown_by_number(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pwd, "getpwuid", {}.__getitem__)
    monkeypatch.setattr(os, "fchmod", refuse)
    with pytest.raises(StorageError, match=f"of user {run.stat().st_uid}"):
        seal.unseal(run)


class Died(BaseException):
    """The process is killed here."""


def dies_at(place: int) -> Callable[[Callable[..., object]], Callable[..., object]]:
    """Return a wrapper of functions that share a count; the call at a place, from 1, and all after it die."""
    calls = itertools.count(1)

    def counted(real: Callable[..., object]) -> Callable[..., object]:
        def call(*args: object, **options: object) -> object:
            if next(calls) >= place:
                raise Died
            return real(*args, **options)

        return call

    return counted


@pytest.mark.parametrize("place", range(1, 15))
@pytest.mark.parametrize("way", ["seal", "unseal"])
def test_wherever_it_dies_manifest_or_marker_stands_never_both(
    run: Path, monkeypatch: pytest.MonkeyPatch, way: str, place: int
) -> None:
    seal.mark_unsealed(run)
    if way == "unseal":
        seal.seal(run, NOW_UTC)
    with monkeypatch.context() as killed:
        counted = dies_at(place)
        for owner, name in (
            (Path, "rename"),
            (Path, "unlink"),
            (Path, "touch"),
            (os, "fsync"),
            (os, "fchmod"),
        ):
            killed.setattr(owner, name, counted(getattr(owner, name)))
        with contextlib.suppress(Died):
            seal.seal(run, NOW_UTC) if way == "seal" else seal.unseal(run)
    assert (seal.read_manifest(run) is None) == seal.is_marked_unsealed(run)
    seal.seal(run, NOW_UTC)
    assert sealed_files(run) == {"run.sqlite"}
    assert {path.name for path in run.iterdir()} == {"run.sqlite", MANIFEST}


def test_all_is_synced_before_the_manifest_is_named(run: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    happened = recorded(monkeypatch)
    seal.seal(run, NOW_UTC)
    named = happened.index(("name", MANIFEST))
    assert ("sync", "run.sqlite") in happened[:named]
    assert ("sync", f"{MANIFEST}.tmp") in happened[:named]
    assert happened[named + 1 :] == [("sync", run.name)]


def test_a_linked_file_keeps_its_permissions(run: Path, outside: Path) -> None:
    (run / "notes").symlink_to(outside)
    seal.seal(run, NOW_UTC)
    assert mode_of(outside) == 0o600
    seal.unseal(run)
    assert mode_of(outside) == 0o600
    assert sealed_files_after(run) == {"run.sqlite"}


def test_a_draft_that_is_a_link_is_not_written_through(run: Path, outside: Path) -> None:
    (run / f"{MANIFEST}.tmp").symlink_to(outside)
    seal.seal(run, NOW_UTC)
    assert outside.read_text() == "secret"
    assert not (run / MANIFEST).is_symlink()
    assert sealed_files(run) == {"run.sqlite"}


def test_a_pipe_in_a_run_is_passed_over(run: Path) -> None:
    os.mkfifo(run / "pipe", 0o600)
    seal.seal(run, NOW_UTC)
    assert mode_of(run / "pipe") == 0o600
    assert sealed_files(run) == {"run.sqlite"}
    seal.unseal(run)


def test_a_folder_in_a_run_can_still_be_entered(run: Path) -> None:
    (run / "photos").mkdir(mode=0o755)
    seal.seal(run, NOW_UTC)
    assert mode_of(run / "photos") == 0o755
    assert sealed_files(run) == {"run.sqlite"}


def test_nobody_gains_the_right_to_read(run: Path) -> None:
    (run / "run.sqlite").chmod(0o640)
    seal.seal(run, NOW_UTC)
    assert mode_of(run / "run.sqlite") == 0o440
    seal.unseal(run)
    assert mode_of(run / "run.sqlite") == 0o640


@pytest.mark.parametrize("kind", ["link", "pipe", "folder"])
def test_a_manifest_that_is_no_file_is_refused(run: Path, outside: Path, kind: str) -> None:
    path = run / MANIFEST
    match kind:
        case "link":
            path.symlink_to(outside)
        case "pipe":
            os.mkfifo(path)
        case _:
            path.mkdir()
    with pytest.raises(StorageError, match=MANIFEST):
        seal.read_manifest(run)


def test_a_manifest_without_end_is_refused(run: Path) -> None:
    seal.seal(run, NOW_UTC)
    (run / MANIFEST).chmod(0o644)
    # A hole: it takes no room on the disk and all of the memory when it is read.
    os.truncate(run / MANIFEST, 1 << 40)
    with pytest.raises(StorageError, match=r"manifest\.json cannot be read: it is larger"):
        seal.read_manifest(run)


def test_a_file_whose_name_is_no_text_is_sealed_too(run: Path) -> None:
    (run / os.fsdecode(b"note\xff")).write_text("odd")
    assert sealed_files_after(run) == {"run.sqlite", r"note\udcff"}
