"""Reading result files of any kind: which kind one is, and what is wrong with one."""

import re
from pathlib import Path
from typing import Final, TypeVar

from pydantic import BaseModel, ValidationError

from catseye.app.errors import UsageError
from catseye.app.files.documents import LARGEST_RESULT_BYTES
from catseye.drivers.roles.user_file import read_regular

_FORMAT: Final = re.compile(r'"format"\s*:\s*"(catseye-[a-z-]+/\d+)"')

ResultT = TypeVar("ResultT", bound=BaseModel)


def format_of(path: Path) -> str:
    """Return the format that a file states, `catseye-result/1` for example; empty where it states none.

    Raises:
        UsageError: the file is missing or cannot be read.
    """
    found = _FORMAT.search(_text(path, "catseye"))
    return found[1] if found else ""


def read_result_file(path: Path, kind: type[ResultT], made_by: str) -> ResultT:
    """Read a result file.

    Args:
        path: of the file.
        kind: its class, whose field `format` has the name of the format as its default.
        made_by: command that writes such files.

    Raises:
        UsageError: the file is missing or no such result; names what is wrong.
    """
    name = kind.model_fields["format"].default
    try:
        result = kind.model_validate_json(_text(path, made_by))
    except ValidationError as error:
        faults = "; ".join(
            f"{'.'.join(str(part) for part in fault['loc']) or 'file'}: {fault['msg']}"
            for fault in error.errors()[:5]
        )
        raise UsageError(f"{path}: is not a {name} file as {made_by} writes it: {faults}") from error
    if "format" not in result.model_fields_set:
        raise UsageError(f'{path}: is not a {name} file: the key "format" is missing')
    return result


def _text(path: Path, made_by: str) -> str:
    try:
        return read_regular(path, LARGEST_RESULT_BYTES).decode("utf-8-sig")
    except FileNotFoundError as error:
        raise UsageError(f"{path}: there is no such file") from error
    except OSError as error:
        raise UsageError(f"{path}: cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise UsageError(
            f"{path}: cannot be read: it is not UTF-8 text, so no result of {made_by}"
        ) from error
