"""Files are replaced whole and keep link, mode and owner; what is no file is written to."""

import errno
import os
import signal
import stat
import subprocess
import sys
from pathlib import Path

import pytest

from catseye.app.errors import StorageError
from catseye.app.files.atomic import write_atomically, write_users_file
from catseye.app.files.crash_points import VARIABLE
from tests.unit.app.disk_order import recorded


def test_a_pipe_takes_the_text_and_stays_one(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    try:
        write_atomically(pipe, "a result\n")
        assert os.read(reader, 100) == b"a result\n"
    finally:
        os.close(reader)
    assert stat.S_ISFIFO(pipe.stat().st_mode)
    assert os.listdir(tmp_path) == ["pipe"]


def test_a_link_stays_and_its_file_is_replaced(tmp_path: Path) -> None:
    (tmp_path / "shared").mkdir()
    real = tmp_path / "shared" / "cell.toml"
    real.write_text("old", "utf-8")
    link = tmp_path / "cell.toml"
    link.symlink_to("shared/cell.toml")
    write_atomically(link, "new")
    assert os.readlink(link) == "shared/cell.toml"
    assert real.read_text("utf-8") == "new"
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["cell.toml", "cell.toml", "shared"]


def test_a_file_is_synced_before_it_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    happened = recorded(monkeypatch)
    write_atomically(tmp_path / "r.json", "new")
    (kind, synced), named = happened
    assert (kind, synced[:8]) == ("sync", ".r.json.")
    assert named == ("name", "r.json")


@pytest.mark.parametrize("fails", ["fsync", "fchmod"])
def test_a_write_that_fails_leaves_the_file_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, fails: str
) -> None:
    path = tmp_path / "r.json"
    path.write_text("old", "utf-8")

    def full(*_: object) -> None:
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(os, fails, full)
    with pytest.raises(StorageError, match=r"r\.json: cannot be written: No space left"):
        write_atomically(path, "new")
    assert path.read_text("utf-8") == "old"
    assert os.listdir(tmp_path) == ["r.json"]


@pytest.mark.parametrize("mode", [0o600, 0o640, 0o664, 0o444])
def test_a_file_that_is_replaced_keeps_its_mode(tmp_path: Path, mode: int) -> None:
    path = tmp_path / "r.json"
    path.write_text("old", "utf-8")
    path.chmod(mode)
    write_atomically(path, "new")
    assert stat.S_IMODE(path.stat().st_mode) == mode
    assert path.read_text("utf-8") == "new"


@pytest.mark.skipif(os.geteuid() != 0, reason="only root may give a file to somebody else")
def test_a_file_that_is_replaced_keeps_its_owner(tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    path.write_text("old", "utf-8")
    os.chown(path, 12345, 23456)
    write_atomically(path, "new")
    assert (path.stat().st_uid, path.stat().st_gid) == (12345, 23456)


def test_an_owner_that_cannot_be_kept_stops_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_file: object, _user: int, _group: int) -> None:
        raise PermissionError

    path = tmp_path / "r.json"
    path.write_text("old", "utf-8")
    monkeypatch.setattr("os.fchown", refuse)
    write_atomically(path, "new")
    assert path.read_text("utf-8") == "new"


def test_a_users_file_that_is_read_only_stays(tmp_path: Path) -> None:
    path = tmp_path / "cell.toml"
    write_users_file(path, "old")
    path.chmod(0o444)
    with pytest.raises(StorageError, match=r"cell\.toml: is read-only, and stays as it is: .*chmod u\+w"):
        write_users_file(path, "new")
    assert path.read_text("utf-8") == "old"
    path.chmod(0o644)
    write_users_file(path, "new")
    assert path.read_text("utf-8") == "new"


WRITES = "import sys; from pathlib import Path; from catseye.app.files.atomic import write_atomically as w; "
"""What a process does before it writes."""


def killed_before_it_names(path: Path) -> None:
    """Write a file in a process that is killed before the draft gets the file's name."""
    words = [sys.executable, "-c", f"{WRITES}w(Path(sys.argv[1]), 'never named')", str(path)]
    killed = subprocess.run(words, env={**os.environ, VARIABLE: "file-drafted"}, check=False)
    assert killed.returncode == -signal.SIGKILL


def test_the_next_write_removes_what_a_kill_has_left(tmp_path: Path) -> None:
    path = tmp_path / "r.json"
    path.write_text("old", "utf-8")
    (tmp_path / ".r.json.original").write_text("somebody's", "utf-8")
    killed_before_it_names(path)
    assert path.read_text("utf-8") == "old"
    assert len(os.listdir(tmp_path)) == 3
    write_atomically(path, "new")
    assert path.read_text("utf-8") == "new"
    assert sorted(os.listdir(tmp_path)) == [".r.json.original", "r.json"]


def test_the_draft_of_a_living_writer_stays(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "r.json"
    replace = Path.replace

    def after_another(draft: Path, target: Path) -> Path:
        monkeypatch.setattr(Path, "replace", replace)
        write_atomically(path, "the other's")
        return replace(draft, target)

    monkeypatch.setattr(Path, "replace", after_another)
    write_atomically(path, "the later one's")
    assert path.read_text("utf-8") == "the later one's"
    assert os.listdir(tmp_path) == ["r.json"]


def test_a_disk_that_turns_read_only_is_said_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def read_only(*_: object, **__: object) -> None:
        raise OSError(errno.EROFS, "Read-only file system")

    path = tmp_path / "r.json"
    path.write_text("old", "utf-8")
    for where, name in ((os, "fsync"), (Path, "unlink")):
        monkeypatch.setattr(where, name, read_only)
    with pytest.raises(StorageError, match=r"r\.json: cannot be written: Read-only"):
        write_atomically(path, "new")
    assert path.read_text("utf-8") == "old"
