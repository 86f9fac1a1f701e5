"""Reading a description, of an arm or of a tool: faults name file and key."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from catseye.app.cell.faults import fault_text
from catseye.app.errors import ConfigError
from catseye.app.files.documents import document_text, parse_toml, read_document

Described = TypeVar("Described", bound=BaseModel)

_MOST_FAULTS = 20
_UNKNOWN = "unknown key: docs/files.md lists those of a description"


def read_described(kind: type[Described], path: Path) -> Described:
    """Read a description.

    Raises:
        ConfigError: the file is missing or no TOML, or keys or values are wrong; the faults are listed.
    """
    text = document_text(read_document(path, "there is no such file: give the path of a description"), path)
    try:
        return kind.model_validate(parse_toml(text, path))
    except ValidationError as error:
        faults = "\n".join(
            f"  {path}: {_place(fault)}: {fault_text(fault, lambda: _UNKNOWN)}"
            for fault in error.errors()[:_MOST_FAULTS]
        )
        raise ConfigError(f"the description cannot be used:\n{faults}") from error


def _place(fault: ErrorDetails) -> str:
    """Return where a fault is, the tables of a list counted from 1: `joint[2].a_mm`."""
    parts = [f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in fault["loc"]]
    return "".join(parts).removeprefix(".") or "file"
