"""A failure as sentences on stderr, never a traceback unless it is asked for."""

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Final

import typer
from typer.exceptions import TyperException

from catseye.app.cli.event_channel import report_failure
from catseye.app.cli.output import json_lines, talk, write_document
from catseye.app.errors import DEBUG, OutputError, ReaderGoneError, exit_code_of, trace_of
from catseye.drivers.roles.text import harmless_lines

SEE_WHERE: Final = f"set {DEBUG}=1 and repeat to see where it happened"
"""Follows a fault of the program."""


def write_failure(error: BaseException) -> int:
    """Write what went wrong to stderr and return the exit code."""
    code = int(exit_code_of(error))
    texts = _sentences(error)
    if trace := trace_of(error):
        talk(trace, heard=False)
        report_failure("\n".join(texts), code)
    else:
        write_failure_texts(texts, code)
    return code


def write_failure_texts(texts: Sequence[str], code: int) -> None:
    """Write to stderr, and report, why the command ends with a code other than 0."""
    texts = [harmless_lines(text) for text in texts]
    for text in texts:
        talk(f"catseye: {text}\n", heard=False)
    if texts:
        report_failure("\n".join(texts), code)


@contextmanager
def failure_as_json(*, as_json: bool, stream: bool = False) -> Iterator[None]:
    """Answer with the error as JSON where that is wanted and no JSON has answered; the error goes on.

    Args:
        stream: lines that were written meanwhile are no answer: the last one has to say how it ended.
    """
    before = json_lines()
    try:
        yield
    except (typer.Exit, typer.Abort, OutputError):
        raise
    except Exception as error:
        if as_json and (stream or json_lines() == before):
            write_document("error", _document(error))
        raise


def _document(error: Exception) -> dict[str, object]:
    from catseye.app.cli.documents import Failure

    if isinstance(error, TyperException):
        return Failure(error=error.format_message(), exit_code=error.exit_code).json_object()
    return Failure(error="\n".join(_sentences(error)), exit_code=int(exit_code_of(error))).json_object()


def _sentences(error: BaseException) -> list[str]:
    if _is_ours(error):
        return _texts(error)
    return [_internal(error), f"this is a fault of the program; {SEE_WHERE}"]


def _texts(error: BaseException) -> list[str]:
    if isinstance(error, KeyboardInterrupt):
        return ["interrupted"]
    if isinstance(error, ReaderGoneError):
        return []
    if isinstance(error, BaseExceptionGroup):
        return [text for inner in error.exceptions for text in _texts(inner)]
    return [str(error)]


def _internal(error: BaseException) -> str:
    return f"internal error: {type(error).__name__}: {error}"


def _is_ours(error: BaseException) -> bool:
    if isinstance(error, KeyboardInterrupt):
        return True
    if isinstance(error, BaseExceptionGroup):
        return all(_is_ours(inner) for inner in error.exceptions)
    return any(kind.__module__.partition(".")[0] == "catseye" for kind in type(error).__mro__)
