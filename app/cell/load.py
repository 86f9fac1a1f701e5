"""Reading a cell file: errors name file, line, key and the nearest valid key."""

import difflib
import hashlib
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from catseye.app.cell.described import is_path
from catseye.app.cell.faults import fault_text
from catseye.app.cell.model import Cell
from catseye.app.errors import ConfigError
from catseye.app.files.documents import document_text, parse_toml, read_document

Place = tuple[int | str, ...]

_MOST_FAULTS = 50
"""Faults that are listed one by one."""


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
        found = error.errors()
        faults = "\n".join(f"  {_sentence(path, text, fault)}" for fault in found[:_MOST_FAULTS])
        if len(found) > _MOST_FAULTS:
            faults += f"\n  and {len(found) - _MOST_FAULTS} further faults"
        raise ConfigError(f"the cell file cannot be used:\n{faults}") from error
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


def _sentence(path: Path, text: str, fault: ErrorDetails) -> str:
    place = fault["loc"]
    return f"{path}:{_line_of(text, place)}: {_dotted(place) or 'file'}: {cell_fault_text(fault)}"


def cell_fault_text(fault: ErrorDetails) -> str:
    """Return what is wrong with one key, in words."""
    return fault_text(fault, lambda: f"unknown key{_nearest(fault['loc'])}")


def _dotted(place: Place) -> str:
    return re.sub(r"\.(\d+)", lambda m: f"[{int(m.group(1)) + 1}]", ".".join(str(part) for part in place))


def _nearest(place: Place) -> str:
    section = _section_at(place[:-1])
    if section is None:
        return ""
    known = list(section.model_fields)
    close = difflib.get_close_matches(str(place[-1]), known, n=1, cutoff=0.5)
    if close:
        return f"; did you mean {close[0]}?"
    return f"; known here: {', '.join(known)}"


def _section_at(place: Place) -> type[BaseModel] | None:
    section: type[BaseModel] = Cell
    for part in place:
        if isinstance(part, int):
            continue
        field = section.model_fields.get(part)
        inner = None if field is None else _model_in(field.annotation)
        if inner is None:
            return None
        section = inner
    return section


def _model_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next((model for inner in get_args(annotation) if (model := _model_in(inner)) is not None), None)


def _line_of(text: str, place: Place) -> int:
    """Return the line that a key stands on, or that of its table, or 1."""
    tables = [str(part) for part in place if not isinstance(part, int)]
    count = next((part for part in place if isinstance(part, int)), 0)
    best, depth, seen = 1, 0, -1
    here: list[str] = []
    for number, line in enumerate(text.splitlines(), 1):
        header = re.match(r"\s*\[\[?\s*([\w.\-]+)\s*\]\]?", line)
        if header:
            here = header.group(1).split(".")
            seen += line.lstrip().startswith("[[") and here == tables[: len(here)]
            if here == tables[: len(here)] and len(here) > depth and (seen < 0 or seen == count):
                best, depth = number, len(here)
            continue
        key = re.match(r'\s*"?([\w\-]+)"?\s*=', line)
        whole = [*here, key.group(1)] if key else []
        if key and whole == tables[: len(whole)] and (seen < 0 or not here or seen == count):
            return number
    return best


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
