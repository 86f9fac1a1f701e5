"""What is wrong with a key of a file, in words."""

import difflib
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

Place = tuple[int | str, ...]

_MOST_FAULTS = 50
"""Faults that are listed one by one."""

_LONGEST = 1000
"""Of a complaint; a list of names that are known may be long."""

_SHOWN_LENGTH = 200
"""Of a wrong value."""


def fault_text(fault: ErrorDetails, unknown: Callable[[], str]) -> str:
    """Return what is wrong with one key.

    Args:
        unknown: returns what there is to say of a key that is not known.
    """
    match fault["type"]:
        case "extra_forbidden":
            return unknown()
        case "missing":
            return "this key is missing"
        case "value_error":
            return _bounded(fault["msg"].removeprefix("Value error, "))
        case "too_short" | "too_long":
            wanted = fault["ctx"].get("min_length", fault["ctx"].get("max_length"))
            return f"give {wanted} values, not {fault['ctx']['actual_length']}: {_shown(fault['input'])}"
        case _:
            return f"{fault['msg']}, not {_shown(fault['input'])}"


def _bounded(text: str) -> str:
    """Return a complaint in which long values of the file stand in part; what to do stands at its end."""
    return text if len(text) <= _LONGEST else f"{text[: _LONGEST // 2]} … {text[-_LONGEST // 2 :]}"


def _shown(value: object) -> str:
    text = repr(value)
    return text if len(text) <= _SHOWN_LENGTH else f"{text[:_SHOWN_LENGTH]}…"


def faults_in(root: type[BaseModel], path: Path, text: str, error: ValidationError) -> str:
    """Return what is wrong with a TOML file: file, line, key and the nearest valid key, a line each.

    Args:
        root: model of the file.
        text: of the file.
    """
    # A default that is worked out from a faulty value is no fault of its own.
    found = [fault for fault in error.errors() if fault["type"] != "default_factory_not_called"]
    lines = [f"  {_sentence(root, path, text, fault)}" for fault in found[:_MOST_FAULTS]]
    if len(found) > _MOST_FAULTS:
        lines.append(f"  and {len(found) - _MOST_FAULTS} further faults")
    return "\n".join(lines)


def key_fault_text(root: type[BaseModel], fault: ErrorDetails) -> str:
    """Return what is wrong with one key of a file, in words.

    Args:
        root: model of the file.
    """
    return fault_text(fault, lambda: f"unknown key{_nearest(root, fault['loc'])}")


def _sentence(root: type[BaseModel], path: Path, text: str, fault: ErrorDetails) -> str:
    place = fault["loc"]
    return f"{path}:{_line_of(text, place)}: {_dotted(place) or 'file'}: {key_fault_text(root, fault)}"


def _dotted(place: Place) -> str:
    return re.sub(r"\.(\d+)", lambda m: f"[{int(m.group(1)) + 1}]", ".".join(str(part) for part in place))


def _nearest(root: type[BaseModel], place: Place) -> str:
    section = _section_at(root, place[:-1])
    if section is None:
        return ""
    known = list(section.model_fields)
    close = difflib.get_close_matches(str(place[-1]), known, n=1, cutoff=0.5)
    if close:
        return f"; did you mean {close[0]}?"
    return f"; known here: {', '.join(known)}"


def _section_at(root: type[BaseModel], place: Place) -> type[BaseModel] | None:
    section = root
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
