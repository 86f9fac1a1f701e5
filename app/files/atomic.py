"""Writing a file whole or not at all."""

import contextlib
import fcntl
import glob
import os
import stat
import tempfile
from pathlib import Path
from typing import Final

from catseye.app.errors import StorageError, UsageError
from catseye.app.files.crash_points import crash_point

_RIGHTS: Final = stat.S_IRWXU | stat.S_IRWXG | stat.S_IRWXO
_WRITABLE: Final = stat.S_IWUSR | stat.S_IWGRP | stat.S_IWOTH
_DRAFT: Final = ".draft"


def require_other_file(output: Path, *inputs: Path | None) -> None:
    """Refuse to write over a file that is read.

    Raises:
        UsageError: the output is one of the inputs.
    """
    for one in inputs:
        if one is not None and one.exists() and output.exists() and output.samefile(one):
            raise UsageError(
                f"{output} is a file that is read, and would be lost: choose another file to write"
            )


def require_output(output: Path | None, *inputs: Path | None) -> None:
    """Refuse an output before the work that leads to it: what is read is never overwritten.

    Args:
        output: file to write; None for none.
        inputs: files that are read; None for those that are not given.

    Raises:
        UsageError: the output is one of the inputs, or a folder.
        StorageError: its folder is missing.
    """
    if output is None:
        return
    if output.is_dir():
        raise UsageError(f"{output}: is a folder; give the name of a file to write")
    if not output.parent.is_dir():
        raise StorageError(f"{output}: cannot be written: there is no folder {output.parent}; make it first")
    require_other_file(output, *inputs)


def write_users_file(path: Path, text: str) -> None:
    """Write a file that a person edits, too: whole or not at all, and never over one that is read-only.

    Raises:
        StorageError: it is read-only, or cannot be written; it stays as it is.
    """
    if path.exists() and not (os.access(path, os.W_OK) and path.stat().st_mode & _WRITABLE):
        raise StorageError(
            f"{path}: is read-only, and stays as it is: allow writing (chmod u+w), or choose another file"
        )
    write_atomically(path, text)


def write_atomically(path: Path, data: str | bytes) -> None:
    """Write a file through a temporary neighbour and a rename; a device or a pipe is written to, never replaced.

    A link stays, and the file that it leads to is replaced. A file that is replaced hands on its mode and, where the
    rights allow it, its owner. What a writer that was killed has left of this file goes first.

    Raises:
        StorageError: the folder is missing, full or not writable; nothing is left behind.
    """
    # Bytes of a path that are no UTF-8 stand as escapes.
    raw = data.encode("utf-8", "backslashreplace") if isinstance(data, str) else data
    temporary: str | None = None
    try:
        if path.exists() and not path.is_file():
            path.write_bytes(raw)
            return
        target = Path(os.path.realpath(path))
        _remove_left_drafts(target)
        handle, temporary = _draft_of(target)
        crash_point("file-begun")
        with os.fdopen(handle, "wb") as file:
            file.write(raw)
            _hand_on_rights(target, file.fileno())
            file.flush()
            os.fsync(file.fileno())
            crash_point("file-drafted")
            # While the lock is held: without it another writer would remove the draft.
            Path(temporary).replace(target)
        crash_point("file-named")
    except OSError as error:
        if temporary is not None:
            # A disk that takes no more changes keeps the draft; the next write removes it.
            with contextlib.suppress(OSError):
                Path(temporary).unlink()
        raise StorageError(
            f"{path}: cannot be written: {error.strerror}; check the folder, its rights and the free space"
        ) from error


def _draft_of(target: Path) -> tuple[int, str]:
    """Make the file that gets the target's name later; the kernel lets go of its lock when the writer dies."""
    while True:
        handle, name = tempfile.mkstemp(_DRAFT, f".{target.name}.", target.parent)
        # Where files cannot be locked nobody removes drafts either.
        with contextlib.suppress(OSError):
            fcntl.flock(handle, fcntl.LOCK_EX)
        if os.fstat(handle).st_nlink:
            return handle, name
        # Another writer took it for left in the instant before.
        os.close(handle)


def _remove_left_drafts(target: Path) -> None:
    """Remove drafts of a file whose writers have died."""
    for draft in target.parent.glob(f".{glob.escape(target.name)}.*{_DRAFT}"):
        with contextlib.suppress(OSError):
            handle = os.open(draft, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
            try:
                fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
                draft.unlink()
            finally:
                os.close(handle)


def _hand_on_rights(target: Path, handle: int) -> None:
    """Give a new file mode and owner of the one that it replaces; without one the umask says who may use it."""
    try:
        before = target.stat()
    except FileNotFoundError:
        umask = os.umask(0)
        os.umask(umask)
        os.fchmod(handle, 0o666 & ~umask)
        return
    with contextlib.suppress(PermissionError):
        os.fchown(handle, before.st_uid, before.st_gid)
    os.fchmod(handle, before.st_mode & _RIGHTS)
