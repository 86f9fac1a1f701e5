"""stdout is data, stderr is talk."""

import json
import os
import sys
from collections.abc import Mapping
from typing import TextIO

from catseye.app.cli.event_channel import report_warning
from catseye.app.cli.outputs import format_of
from catseye.app.errors import OutputError, ReaderGoneError, ReaderStuckError
from catseye.drivers.roles.text import harmless_lines


def write_line(text: str) -> None:
    """Write a line of data to stdout at once, harmless to a terminal.

    Raises:
        OutputError: stdout takes no more; what is written later goes nowhere.
    """
    _write(harmless_lines(text))


def _write(text: str) -> None:
    try:
        sys.stdout.write(text + "\n")
        sys.stdout.flush()
    except ReaderStuckError:
        raise
    except OSError as error:
        _give_up(sys.stdout)
        if isinstance(error, BrokenPipeError):
            raise ReaderGoneError("stdout is closed") from error
        raise OutputError(
            f"stdout cannot be written: {error.strerror}: make room, or send it elsewhere"
        ) from error


def _give_up(stream: TextIO) -> None:
    """Let what is written from now on go nowhere: the buffer would fail once more when the interpreter ends."""
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), stream.fileno())


_json_lines = 0


def json_lines() -> int:
    """Return how many JSON values this process has written to stdout."""
    return _json_lines


def write_document(name: str, *documents: Mapping[str, object]) -> None:
    """Write documents to stdout, each on a line of its own, all or none of them; see `document_line`."""
    global _json_lines  # one process has one stdout
    _json_lines += len(documents)
    _write("\n".join(document_line(name, fields) for fields in documents))


def document_line(name: str, fields: Mapping[str, object]) -> str:
    """Return a document as its line, its format first.

    Args:
        name: of the document in `OUTPUTS`.
        fields: of its model, as JSON has them.
    """
    value = {"format": format_of(name)} | {key: fields[key] for key in fields if key != "format"}
    # Bytes of a path that are no UTF-8 stand as escapes, which JSON reads back as they were.
    return json.dumps(value, ensure_ascii=False).encode(errors="backslashreplace").decode()


def note(text: str, *, heard: bool = False) -> None:
    """Write a line of talk to stderr at once, harmless to a terminal.

    Args:
        heard: somebody has to be there to read it; see `talk`.
    """
    talk(harmless_lines(text) + "\n", heard=heard)


def talk(text: str, *, heard: bool) -> None:
    """Write to stderr at once.

    Args:
        heard: somebody has to be there to read it, as while an arm moves; else work goes on without a reader.

    Raises:
        OSError: it has to be heard, and stderr takes no more; what is written later goes nowhere.
    """
    try:
        sys.stderr.write(text)
        sys.stderr.flush()
    except OSError as error:
        if not isinstance(error, ReaderStuckError):
            _give_up(sys.stderr)
        if heard:
            raise


def warn(text: str) -> None:
    """Warn people on stderr, and the program that started this one."""
    note(f"warning: {text}")
    report_warning(harmless_lines(text))
