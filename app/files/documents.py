"""TOML and JSON that a user wrote: read from a regular file of bounded size, every fault named."""

import json
from pathlib import Path
from typing import Any, Final

from catseye.app.errors import ConfigError
from catseye.drivers.roles.user_file import LARGEST_BYTES, LARGEST_INTEGER, TOO_LONG, read_regular, toml_table

MISSING: Final = "there is no such file"

LARGEST_RESULT_BYTES: Final = 64 * 1024 * 1024
"""A result file holds a residual for each of its distances."""

_INTEGER_DIGITS: Final = 20
"""Of 64 bits, with a sign; longer texts are not converted at all."""


def is_file(path: Path) -> bool:
    """Return whether there is a file; a text that no file can be called names none."""
    try:
        return path.is_file()
    except OSError:
        return False


def read_document(path: Path, missing: str = MISSING, largest_bytes: int = LARGEST_BYTES) -> bytes:
    """Return the bytes of a user's file.

    Args:
        path: a regular file.
        missing: complaint when there is none.
        largest_bytes: larger files are refused.

    Raises:
        ConfigError: the file is missing, no regular one, too large, or cannot be read.
    """
    try:
        return read_regular(path, largest_bytes)
    except FileNotFoundError as error:
        raise ConfigError(f"{path}: {missing}") from error
    except OSError as error:
        raise ConfigError(f"{path}: cannot be read: {error.strerror}") from error


def read_text(path: Path, missing: str = MISSING) -> str:
    """Return the text of a user's file, without the byte order mark that editors of another system put first.

    Raises:
        ConfigError: as for `read_document`, or it is no UTF-8 text.
    """
    return document_text(read_document(path, missing), path)


def document_text(raw: bytes, where: object) -> str:
    """Return the text of bytes.

    Raises:
        ConfigError: they are no UTF-8 text.
    """
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ConfigError(f"{where}: not in UTF-8 ({error}): save it as UTF-8 text") from error


def read_toml(path: Path) -> dict[str, Any]:
    """Return the table of a TOML file.

    Raises:
        ConfigError: as for `read_text`, or it is no TOML.
    """
    return parse_toml(read_text(path), path)


def parse_toml(text: str, where: object) -> dict[str, Any]:
    """Return the table of a TOML text.

    Args:
        where: it comes from, for the error.

    Raises:
        ConfigError: it is no TOML, nested too deeply, or holds an integer beyond 64 bits.
    """
    try:
        return toml_table(text)
    except ValueError as error:
        raise ConfigError(f"{where}: {error}") from error


def parse_json(text: str | bytes, where: object) -> Any:
    """Return the value of a JSON text.

    Raises:
        ConfigError: it is no JSON, nested too deeply, or holds NaN, infinity or an integer beyond 64 bits.
    """
    try:
        return json.loads(text, parse_int=_integer, parse_constant=_no_number)
    except RecursionError as error:
        raise ConfigError(f"{where}: not a JSON file: its objects or lists are nested too deeply") from error
    except ValueError as error:
        raise ConfigError(f"{where}: not a JSON file: {error}") from error


def _integer(digits: str) -> int:
    if len(digits) > _INTEGER_DIGITS or abs(int(digits)) > LARGEST_INTEGER:
        raise ValueError(TOO_LONG)
    return int(digits)


def _no_number(name: str) -> None:
    raise ValueError(f"{name} is not a JSON number")


def read_truth(path: Path) -> dict[str, Any]:
    """Return the document of a true arm that an emulated bench wrote.

    Raises:
        ConfigError: the file cannot be used.
    """
    document: dict[str, Any] = parse_json(read_document(path), path)
    return document
