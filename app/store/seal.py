"""Closing a run's directory: read-only files and a manifest of their contents."""

import hashlib
import json
import os
import pwd
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from pydantic import BaseModel, ValidationError

from catseye.app.errors import StorageError
from catseye.app.files.crash_points import crash_point

MANIFEST = "manifest.json"
DATABASE = "run.sqlite"
WIRE_LOG = "wire.log"
APP_LOG = "app.log"

_LARGEST_MANIFEST_BYTES = 4 * 1024 * 1024
"""For the few files of a run; a list of runs reads every manifest whole."""

UNSEALED = "unsealed"
"""A file that stands for the manifest until there is one: a run that has neither has lost its manifest.

What it holds says nothing: it is empty in a new run, and an earlier manifest in one that went on.
"""

PROMISED = "sealed"
"""Key of a closing record after which a manifest follows; older programs did not say so."""

_DRAFT = f"{MANIFEST}.tmp"

# SQLite's shared memory file is an index of the log beside it: it carries no data and changes when read.
_IGNORED = {MANIFEST, UNSEALED, _DRAFT, f"{DATABASE}-shm"}

_WRITTEN = (DATABASE, f"{DATABASE}-wal", f"{DATABASE}-shm", f"{DATABASE}-journal", WIRE_LOG, APP_LOG)

_WRITING = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH


class SealedFile(BaseModel):
    """One file of a sealed run.

    Attributes:
        sha256: hexadecimal digest.
        bytes: size.
    """

    sha256: str
    bytes: int


class Manifest(BaseModel):
    """What a run's directory holds.

    Attributes:
        format: name and version of this format.
        run: the run's name.
        created_utc: when it was sealed.
        files: every file, by name.
    """

    format: str = "catseye-manifest/1"
    run: str
    created_utc: str
    files: dict[str, SealedFile]


def digest(directory: Path) -> dict[str, SealedFile]:
    """Return the digests of a run's files; links, pipes, devices and folders are none."""
    return {
        _manifest_name(path.name): _digest_file(path)
        for path in _own_files(directory)
        if path.name not in _IGNORED
    }


def seal(directory: Path, created_utc: str) -> None:
    """Write the manifest so that it is either complete or absent, and take the write permission away.

    Whatever else lies in the directory keeps its permissions: what a link leads to is not the run's.
    """
    for path in _own_files(directory):
        with _held(path) as descriptor:
            os.fsync(descriptor)
            _read_only(descriptor)
    manifest = Manifest(run=directory.name, created_utc=created_utc, files=digest(directory))
    draft = directory / _DRAFT
    draft.unlink(missing_ok=True)
    # Exclusively: a link that somebody puts there meanwhile is refused, not followed.
    with draft.open("x", encoding="utf-8") as file:
        file.write(json.dumps(manifest.model_dump(), indent=1) + "\n")
        file.flush()
        os.fsync(file.fileno())
        _read_only(file.fileno())
    # The mark becomes the manifest: whenever the process dies, one of them is there and never both.
    marker = draft.rename(directory / UNSEALED)
    crash_point("before-manifest")
    marker.rename(directory / MANIFEST)
    _sync(directory)


def mark_unsealed(directory: Path) -> None:
    """Mark a run that has no manifest yet, before its record says that it has one."""
    if not is_marked_unsealed(directory):
        (directory / UNSEALED).touch(exist_ok=False)
        _sync(directory)


def is_marked_unsealed(directory: Path) -> bool:
    """Return whether a run is known to have no manifest; one of an older program is not marked."""
    return os.path.lexists(directory / UNSEALED)


def require_own_files(directory: Path) -> None:
    """Refuse to go on with a run whose files are links, pipes or devices: those lead to what is not the run's.

    Raises:
        StorageError: one is; names it.
    """
    for name in _WRITTEN:
        path = directory / name
        if not os.path.lexists(path) or stat.S_ISREG(path.lstat().st_mode):
            continue
        what = f"a link, to {os.readlink(path)}" if path.is_symlink() else "no regular file"
        raise StorageError(
            f"{path} is {what}: nothing is written there; remove it, or restore the file of the run"
        )


def unseal(directory: Path) -> None:
    """Give the write permission back and make the manifest the mark of a run without one, to go on with it.

    Raises:
        StorageError: it cannot be written; the manifest is still there.
    """
    try:
        # First what fails for somebody else's files: the manifest goes only when the run can go on.
        for path in _own_files(directory):
            with _held(path) as descriptor:
                os.fchmod(descriptor, os.fstat(descriptor).st_mode | stat.S_IWUSR)
        (directory / _DRAFT).unlink(missing_ok=True)
        if os.path.lexists(directory / MANIFEST):
            (directory / MANIFEST).rename(directory / UNSEALED)
            _sync(directory)
        else:
            mark_unsealed(directory)
    except OSError as error:
        raise StorageError(
            f"{directory} of {_owner(directory)} cannot be made writable: {error}; "
            "let its owner resume it, and check that the disk can be written"
        ) from error


def read_manifest(directory: Path) -> Manifest | None:
    """Return the manifest, None when the run is not sealed.

    Raises:
        StorageError: the manifest is damaged, or too large to be one.
    """
    path = directory / MANIFEST
    try:
        with _held(path) as descriptor, open(descriptor, "rb", closefd=False) as file:
            raw = file.read(_LARGEST_MANIFEST_BYTES + 1)
            if len(raw) > _LARGEST_MANIFEST_BYTES:
                raise OSError(f"it is larger than {_LARGEST_MANIFEST_BYTES} bytes, which no manifest is")
            return Manifest.model_validate_json(raw)
    except FileNotFoundError:
        return None
    except ValidationError as error:
        raise StorageError(f"{path} is damaged: {error.errors()[0]['msg']}") from error
    except OSError as error:
        raise StorageError(f"{path} cannot be read: {error}") from error


def _owner(directory: Path) -> str:
    uid = directory.stat().st_uid
    try:
        return pwd.getpwuid(uid).pw_name
    except KeyError:
        return f"user {uid}"


def _manifest_name(name: str) -> str:
    """Return the name of a file for the manifest: bytes that are no UTF-8 stand as escapes, which JSON takes."""
    return name.encode(errors="backslashreplace").decode()


def _own_files(directory: Path) -> list[Path]:
    return sorted(path for path in directory.iterdir() if stat.S_ISREG(path.lstat().st_mode))


@contextmanager
def _held(path: Path) -> Iterator[int]:
    """Yield the descriptor of a regular file, opened for reading.

    Raises:
        OSError: it cannot be opened, or is a link, a pipe or a device.
    """
    descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise OSError(f"{path} is not a regular file; remove it")
        yield descriptor
    finally:
        os.close(descriptor)


def _read_only(descriptor: int) -> None:
    os.fchmod(descriptor, os.fstat(descriptor).st_mode & ~_WRITING)


def _digest_file(path: Path) -> SealedFile:
    with _held(path) as descriptor, open(descriptor, "rb", closefd=False) as file:
        found = hashlib.file_digest(file, "sha256").hexdigest()
        return SealedFile(sha256=found, bytes=os.fstat(descriptor).st_size)


def _sync(directory: Path) -> None:
    descriptor = os.open(directory, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)
