"""Reading a file that a user names: a regular one, of bounded size, without ever waiting for it; and TOML from it."""

import errno
import os
import stat
import tomllib
from pathlib import Path
from typing import Any, Final

LARGEST_BYTES: Final = 4 * 1024 * 1024
"""No configuration that a person writes comes near."""

LARGEST_INTEGER: Final = 2**63 - 1
"""TOML promises no more, and the text of a much longer one cannot even be made."""

TOO_LONG: Final = "an integer is too long: it may have 64 bits"

_CHUNK_BYTES: Final = 1024 * 1024

_KINDS: Final = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)


def read_regular(path: Path, largest_bytes: int = LARGEST_BYTES) -> bytes:
    """Return the bytes of a file.

    Args:
        path: of the file; symbolic links are followed.

    Raises:
        OSError: it is missing, no regular file, larger, or cannot be read; `strerror` says which.
    """
    try:
        # A device is not even opened: that alone may do something to it.
        require_regular(path)
        descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK | os.O_CLOEXEC | os.O_NOCTTY)
    except ValueError as error:
        raise OSError(errno.EINVAL, f"is not a file name ({error})", repr(str(path))) from error
    with os.fdopen(descriptor, "rb", buffering=0) as file:
        facts = os.fstat(descriptor)
        _require_kind(path, facts)
        _require_size(path, facts.st_size, largest_bytes)
        raw = bytearray()
        # A file may grow meanwhile, and those of the kernel have no size.
        while chunk := file.read(_CHUNK_BYTES):
            raw += chunk
            _require_size(path, len(raw), largest_bytes)
    return bytes(raw)


def require_regular(path: Path) -> None:
    """Refuse what is no regular file, without opening it.

    Raises:
        OSError: it is missing or something else; `strerror` says what.
    """
    _require_kind(path, path.stat())


def _require_kind(path: Path, facts: os.stat_result) -> None:
    if not stat.S_ISREG(facts.st_mode):
        kind = next((kind for is_kind, kind in _KINDS if is_kind(facts.st_mode)), "no file")
        text = f"is {kind}, not a regular file: write what it holds into a file and name that"
        raise OSError(errno.EINVAL, text, str(path))


def _require_size(path: Path, size: int, largest_bytes: int) -> None:
    if size > largest_bytes:
        raise OSError(
            errno.EFBIG,
            f"is larger than {largest_bytes // 1024} KiB, the most that such a file may have: check the path",
            str(path),
        )


def toml_table(text: str) -> dict[str, Any]:
    """Return the table of a TOML text.

    Raises:
        ValueError: it is no TOML, nested too deeply, or holds an integer beyond 64 bits; the text says which.
    """
    try:
        table = tomllib.loads(text)
        _require_integers(table)
    except RecursionError:
        raise ValueError("not a TOML file: its tables or lists are nested too deeply") from None
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"not a TOML file: {error}") from None
    except ValueError:
        # Thousands of digits are refused before anybody can look at the number.
        raise ValueError(TOO_LONG) from None
    return table


def _require_integers(value: object) -> None:
    if isinstance(value, dict | list):
        for inner in value.values() if isinstance(value, dict) else value:
            _require_integers(inner)
    elif isinstance(value, int) and abs(value) > LARGEST_INTEGER:
        raise ValueError(TOO_LONG)
