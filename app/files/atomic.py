"""Writing a file whole or not at all."""

import contextlib
import os
import tempfile
from pathlib import Path

from catseye.app.errors import StorageError, UsageError


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


def write_atomically(path: Path, data: str | bytes) -> None:
    """Write a file through a temporary neighbour and a rename; a device or a pipe is written to, never replaced.

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
        handle, temporary = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.")
        with os.fdopen(handle, "wb") as file:
            file.write(raw)
            file.flush()
            os.fsync(file.fileno())
        # mkstemp makes private files; a result is for everyone whom the umask allows.
        umask = os.umask(0)
        os.umask(umask)
        Path(temporary).chmod(0o666 & ~umask)
        Path(temporary).replace(path)
    except OSError as error:
        if temporary is not None:
            with contextlib.suppress(FileNotFoundError):
                Path(temporary).unlink()
        raise StorageError(
            f"{path}: cannot be written: {error.strerror}; check the folder, its rights and the free space"
        ) from error
