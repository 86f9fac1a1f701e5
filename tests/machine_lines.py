"""Lines that commands write for programs, held against their published schemas."""

import json
from collections.abc import Iterator
from functools import cache
from typing import Any, Final

from jsonschema import Draft202012Validator

from catseye.app.cli.outputs import OUTPUTS, format_of, schema_of

_FREE: Final = frozenset({"WarningData", "SnapshotLine", "AnswerLine"})
"""Models to which their authors add fields that no schema names."""


def faults_of(text: str) -> list[str]:
    """Return what is wrong with lines of stdout: none without a format, no field that the schema does not name."""
    return [fault for line in text.splitlines() if line.strip() for fault in _faults(line)]


def _faults(line: str) -> Iterator[str]:
    constants: list[str] = []
    value = json.loads(line, parse_constant=constants.append)
    yield from (f"{name} is no JSON: {line[:200]}" for name in constants)
    if not isinstance(value, dict) or value.get("format") not in _names():
        yield f"no format of ours: {line[:200]}"
        return
    for error in _validator(_names()[value["format"]]).iter_errors(value):
        yield f"{value['format']} at {error.json_path}: {error.message[:300]}"


@cache
def _names() -> dict[str, str]:
    return {format_of(name): name for name in OUTPUTS}


@cache
def _validator(name: str) -> Draft202012Validator:
    schema = schema_of(name)
    # A line of `attach` is one of many, each with the version of the messages.
    return Draft202012Validator(schema if name == "attached" else _closed(schema))


def _closed(part: Any) -> Any:
    """Return a schema that takes no field which it does not name."""
    if isinstance(part, list):
        return [_closed(one) for one in part]
    if not isinstance(part, dict):
        return part
    closed = {key: _closed(one) for key, one in part.items()}
    if part.get("type") == "object" and "properties" in part and part.get("title") not in _FREE:
        closed["properties"] = {"format": True} | closed["properties"]
        closed["additionalProperties"] = False
    return closed
