"""Reading a description, of an arm or of a tool: faults name file and key."""

from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ValidationError

from catseye.app.errors import ConfigError
from catseye.app.files.documents import document_text, parse_toml, read_document

Described = TypeVar("Described", bound=BaseModel)

_MOST_FAULTS = 20


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
            f"  {path}: {'.'.join(map(str, fault['loc'])) or 'file'}: {fault['msg'].removeprefix('Value error, ')}"
            for fault in error.errors()[:_MOST_FAULTS]
        )
        raise ConfigError(f"the description cannot be used:\n{faults}") from error
