"""Where the socket of a run is, and making it so that only its owner reaches it."""

import fcntl
import hashlib
import os
import socket
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from catseye.app.service.errors import ServiceError

_LONGEST_PATH_BYTES = 100
"""The kernel takes 107; every system takes this."""

_PROBE_S = 1.0

_REMEDY = "set XDG_RUNTIME_DIR to a folder that only you may enter, for engine and clients alike"


def socket_folder() -> Path:
    """Return the folder of this user's sockets, made when missing.

    Raises:
        ServiceError: it belongs to somebody else, or others may enter it.
    """
    folder = _folders()[0]
    try:
        folder.mkdir(mode=0o700, exist_ok=True)
        found, above = folder.lstat(), folder.parent.stat()
    except OSError as error:
        raise ServiceError(f"{folder}: no folder for sockets can be made: {error}") from error
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid():
        raise ServiceError(
            f"{folder} is not a folder of this user, so its sockets cannot be trusted: {_REMEDY}, "
            "or have the owner or root remove it"
        )
    if stat.S_IMODE(found.st_mode) & 0o077:
        raise ServiceError(f"{folder} is open to others: chmod 700 {folder}, after a look at what is in it")
    if above.st_uid not in {0, os.getuid()} or (above.st_mode & 0o022 and not above.st_mode & stat.S_ISVTX):
        raise ServiceError(
            f"others may exchange {folder}, since {folder.parent} is theirs or open to them: {_REMEDY}"
        )
    return folder


def socket_name(place: Path) -> str:
    """Return the name of the socket of a run's directory, or of a folder of runs."""
    return hashlib.sha256(os.fsencode(place.resolve())).hexdigest()[:16] + ".sock"


def find_socket(place: Path) -> Path | None:
    """Return the socket that serves a run's directory or a folder of runs; None when there is none."""
    found = [folder / socket_name(place) for folder in _folders() if _is_own(folder)]
    return next((path for path in found if path.is_socket()), None)


def is_live(path: Path) -> bool:
    """Return whether somebody listens at a socket; one that is too busy to say so counts."""
    with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as probe:
        probe.settimeout(_PROBE_S)
        try:
            probe.connect(os.fspath(path))
        except (ConnectionRefusedError, FileNotFoundError):
            return False
        except OSError:
            return True
    return True


def all_sockets() -> list[Path]:
    """Return this user's sockets; whether anybody listens is not known."""
    return sorted({path for folder in _folders() if _is_own(folder) for path in folder.glob("*.sock")})


@contextmanager
def listening(place: Path) -> Iterator[socket.socket]:
    """Listen for clients of a run's directory, or of a folder of runs; the socket's file is removed at the end.

    Raises:
        ServiceError: another process listens there, or no socket can be made.
    """
    path = socket_folder() / socket_name(place)
    listener = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
    try:
        inode = _bind(listener, path)
        try:
            yield listener
        finally:
            if path.exists() and path.lstat().st_ino == inode:
                path.unlink()
    finally:
        listener.close()


def _bind(listener: socket.socket, path: Path) -> int:
    """Bind, close to others, and only then listen; return the inode of the socket's file."""
    try:
        with _alone(path.parent):
            if path.exists():
                _remove_stale(path)
            listener.bind(os.fspath(path))
            path.chmod(0o600)
            listener.listen()
            listener.setblocking(False)
            return path.lstat().st_ino
    except OSError as error:
        raise ServiceError(f"{path}: no socket can be made: {error}") from error


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Keep another starting engine from taking this one's new socket for a stale one."""
    descriptor = os.open(folder, os.O_RDONLY)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX)
        yield
    finally:
        os.close(descriptor)


def _remove_stale(path: Path) -> None:
    if not path.is_socket():
        raise ServiceError(f"{path} is not a socket: move it away")
    if is_live(path):
        raise ServiceError(f"another engine listens at {path}: attach to it, or end it first")
    path.unlink(missing_ok=True)


def _folders() -> list[Path]:
    """Return where sockets may be; the first is where they are made.

    A run started by a timer or over ssh has another environment than the terminal that attaches to it.
    """
    user = os.getuid()
    runtime = os.environ.get("XDG_RUNTIME_DIR")
    places = [Path(runtime)] if runtime else []
    places.append(Path(f"/run/user/{user}"))
    fitting = [place / "catseye" for place in places if place.is_dir() and _fits(place / "catseye")]
    fallback = Path(f"/tmp/catseye-{user}")
    made_in = fitting[:1] if runtime else []
    return [*dict.fromkeys([*made_in, fallback, *fitting])]


def _fits(folder: Path) -> bool:
    return len(os.fsencode(folder / ("0" * 16 + ".sock"))) <= _LONGEST_PATH_BYTES


def _is_own(folder: Path) -> bool:
    try:
        found = folder.lstat()
    except OSError:
        return False
    return stat.S_ISDIR(found.st_mode) and found.st_uid == os.getuid()
