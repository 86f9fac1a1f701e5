"""Where sockets are, who may reach them, and what becomes of old ones."""

import os
import socket
import stat
from pathlib import Path

import pytest

from catseye.app.service.address import all_sockets, find_socket, listening, socket_folder, socket_name
from catseye.app.service.errors import ServiceError


def test_a_socket_is_private_and_removed_at_the_end(tmp_path: Path, runtime: Path) -> None:
    with listening(tmp_path):
        path = find_socket(tmp_path)
        assert path == runtime / "catseye" / socket_name(tmp_path)
        assert stat.S_IMODE(path.stat().st_mode) == 0o600
        assert stat.S_IMODE(path.parent.stat().st_mode) == 0o700
        assert path in all_sockets()
    assert find_socket(tmp_path) is None


@pytest.mark.usefixtures("runtime")
def test_a_socket_name_follows_the_resolved_path(tmp_path: Path) -> None:
    (tmp_path / "run").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "run")
    assert socket_name(tmp_path / "link") == socket_name(tmp_path / "run" / ".." / "run")
    assert socket_name(tmp_path / "run") != socket_name(tmp_path)
    assert len(socket_name(tmp_path / ("x" * 200))) == 21


@pytest.mark.usefixtures("runtime")
def test_a_live_socket_is_not_taken_over(tmp_path: Path) -> None:
    with listening(tmp_path):
        with pytest.raises(ServiceError, match="another engine listens"), listening(tmp_path):
            pass
        path = find_socket(tmp_path)
        assert path is not None
        with socket.socket(socket.AF_UNIX) as probe:
            probe.connect(str(path))


def test_a_stale_socket_is_replaced_and_another_one_left_alone(tmp_path: Path, runtime: Path) -> None:
    path = socket_folder() / socket_name(tmp_path)
    with socket.socket(socket.AF_UNIX) as dead:
        dead.bind(str(path))
    with listening(tmp_path):
        path.unlink()
        # Another engine's socket under the same name is not this one's to remove.
        with socket.socket(socket.AF_UNIX) as other:
            other.bind(str(path))
    assert path.is_socket()
    path.unlink()
    path.write_text("not a socket")
    with pytest.raises(ServiceError, match="is not a socket"), listening(tmp_path):
        pass
    assert path.read_text() == "not a socket"
    assert runtime in path.parents


def test_a_folder_that_others_may_enter_is_refused(runtime: Path) -> None:
    folder = runtime / "catseye"
    folder.mkdir()
    folder.chmod(0o750)
    with pytest.raises(ServiceError, match=f"chmod 700 {folder}"):
        socket_folder()
    folder.rmdir()
    (runtime / "elsewhere").mkdir(mode=0o700)
    folder.symlink_to(runtime / "elsewhere")
    with pytest.raises(ServiceError, match="is not a folder of this user"):
        socket_folder()


def test_a_foreign_folder_is_refused(runtime: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (runtime / "catseye").mkdir(mode=0o700)
    owner = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: owner + 1)
    with pytest.raises(ServiceError, match="is not a folder of this user"):
        socket_folder()
    assert runtime / "catseye" / "x" not in all_sockets()


def test_a_foreign_folder_is_refused_with_a_remedy(runtime: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (runtime / "catseye").mkdir(mode=0o700)
    owner = os.getuid()
    monkeypatch.setattr(os, "getuid", lambda: owner + 1)
    with pytest.raises(ServiceError, match="set XDG_RUNTIME_DIR to a folder that only you may enter"):
        socket_folder()


def test_a_folder_that_others_may_exchange_is_refused(runtime: Path) -> None:
    runtime.chmod(0o777)
    with pytest.raises(ServiceError, match="others may exchange"):
        socket_folder()
    runtime.chmod(0o1777)
    assert socket_folder() == runtime / "catseye"


def test_a_runtime_folder_with_a_long_path_is_avoided(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    long = tmp_path / ("x" * 90)
    long.mkdir()
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(long))
    assert long not in socket_folder().parents
    assert len(str(socket_folder() / socket_name(tmp_path))) <= 100
