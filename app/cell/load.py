"""Reading a cell file: errors name file, line, key and the nearest valid key."""

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from catseye.app.cell.described import is_path
from catseye.app.cell.faults import faults_in, key_fault_text
from catseye.app.cell.model import Cell
from catseye.app.errors import ConfigError
from catseye.app.files.documents import document_text, parse_toml, read_document


@dataclass(frozen=True)
class LoadedCell:
    """A cell file that has passed every check.

    Attributes:
        cell: its values.
        path: where it was read.
        sha256: of its bytes.
        origins: dotted key to "file" or "default", for every value.
    """

    cell: Cell
    path: Path
    sha256: str
    origins: dict[str, str]


def load_cell(path: Path) -> LoadedCell:
    """Read and check a cell file.

    Raises:
        ConfigError: the file is missing, is no TOML, or a key or value is wrong; the faults are listed.
    """
    raw = read_document(path, f"there is no such file; write one with: catseye init {path}")
    text = document_text(raw, path)
    data = parse_toml(text, path)
    _find_descriptions(data, path)
    try:
        cell = Cell.model_validate(data)
    except ValidationError as error:
        raise ConfigError(f"the cell file cannot be used:\n{faults_in(Cell, path, text, error)}") from error
    return LoadedCell(cell, path, hashlib.sha256(raw).hexdigest(), _origins(cell, data, ""))


def _find_descriptions(data: dict[str, Any], path: Path) -> None:
    """Put the whole paths of an arm's and a tool's description in place of those from the cell file's folder."""
    robot = data.get("robot")
    if not isinstance(robot, dict):
        return
    arm, tool = robot.get("arm"), robot.get("tool")
    if isinstance(arm, str) and is_path(arm):
        robot["arm"] = str((path.parent / arm).absolute())
    if isinstance(tool, str) and is_path(tool):
        robot["tool"] = str((path.parent / tool).absolute())


def cell_fault_text(fault: ErrorDetails) -> str:
    """Return what is wrong with one key, in words."""
    return key_fault_text(Cell, fault)


def _origins(section: BaseModel, given: Any, prefix: str) -> dict[str, str]:
    found: dict[str, str] = {}
    for name in (*type(section).model_fields, *(section.model_extra or {})):
        value, inside = getattr(section, name), isinstance(given, dict) and name in given
        key = f"{prefix}{name}"
        if isinstance(value, BaseModel):
            found |= _origins(value, given[name] if inside else None, f"{key}.")
        elif isinstance(value, list) and value and isinstance(value[0], BaseModel):
            for i, item in enumerate(value):
                found |= _origins(item, given[name][i] if inside else None, f"{key}[{i + 1}].")
        else:
            found[key] = "file" if inside else "default"
    return found
