"""Installed drivers by what they drive, with what each is for, and the settings that each has."""

import re
from collections.abc import Iterator
from functools import cache
from types import NoneType, UnionType
from typing import Any, Final, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from catseye.app.cell.wizard.question import Choice, Question, text_of
from catseye.drivers.roles.registry import driver_names, load_driver

Role = Literal["robot", "interferometer", "environment", "io", "tracker"]

_ABILITIES: Final[dict[Role, str]] = {
    "robot": "joints",
    "interferometer": "zero",
    "environment": "sample",
    "io": "door_closed",
    "tracker": "locate",
}
"""A method that only drivers of a role have."""

_WORDS: Final = {
    "melfa-r3": "MELFA controller as delivered; stands still at every target",
    "melfa-datalink": "MELFA with program CATSDL: passes targets in one motion",
    "melfa-mxt": "MELFA with program CATSMXT: streams set points",
    "line-counter": "counter with text commands; a profile tells them (DISTAX too)",
    "attocube-ids": "attocube IDS3010 and newer, JSON over TCP",
    "heidenhain-nd": "display HEIDENHAIN ND 287 and older, serial",
    "lasertex-hpi": "Lasertex HPI-3D, serial",
    "umd": "µMD interferometer display, serial",
    "modbus-air": "Modbus TCP or RTU: Vaisala, Comet, or registers of your own",
    "vaisala-ascii": "Vaisala PTU300, serial text commands",
    "modbus-io": "Modbus TCP or RTU: door contact and stack light",
    "bench-tracker": "the emulated bench's own; there is none for real hardware",
}


@cache
def drivers_of(role: Role) -> tuple[Choice, ...]:
    """Return the installed drivers of a role; those of others say of themselves what they are."""
    return tuple(
        Choice(name, _WORDS.get(name) or _summary(driver))
        for name, driver in _installed()
        if hasattr(driver, _ABILITIES[role])
    )


def setting_questions(section: str, driver: str, without: frozenset[str]) -> tuple[Question, ...]:
    """Return a question for each setting of a driver, from the driver's own model.

    Args:
        section: of the cell file.
        driver: its name; none that is installed has no settings.
        without: settings that have questions of their own.
    """
    model = dict(_installed())[driver].Settings if driver in dict(_installed()) else None
    if model is None:
        return ()
    words = _attributes(model)
    asked = (
        _question(section, name, field, words.get(name, ""))
        for name, field in model.model_fields.items()
        if name not in without
    )
    return tuple(question for question in asked if question is not None)


@cache
def _installed() -> tuple[tuple[str, Any], ...]:
    return tuple((name, load_driver(name)) for name in driver_names())


def _summary(driver: Any) -> str:
    lines = (driver.__doc__ or "").strip().splitlines()
    return lines[0] if lines else ""


def _attributes(model: Any) -> dict[str, str]:
    """Return what the docstrings of a model say of each setting."""
    found: dict[str, str] = {}
    for kind in reversed(model.__mro__):
        text = re.sub(r"\n {12,}", " ", kind.__doc__ or "")
        found |= dict(re.findall(r"^\s+(\w+): (.+)$", text, re.MULTILINE))
    return found


def _question(section: str, name: str, field: FieldInfo, words: str) -> Question | None:
    key = f"{section}.settings.{name}"
    kinds = list(_kinds(field.annotation))
    default = "" if field.is_required() else text_of(field.default)
    choices = [value for kind in kinds for value in (get_args(kind) if get_origin(kind) is Literal else ())]
    if bool in kinds:
        choices = [True, False]
    if choices:
        offered = tuple(Choice(value) for value in choices)
        return Question(key, name, words, "choice", offered, default=default)
    if set(kinds) <= {int, float}:
        return Question(key, name, words, "number", default=default)
    # Tables within settings are written into the file by hand; docs/files.md has their keys.
    return Question(key, name, words, default=default) if kinds == [str] else None


def _kinds(annotation: Any) -> Iterator[Any]:
    """Return the types that a setting may have, without None."""
    if get_origin(annotation) in {Union, UnionType}:
        for inner in get_args(annotation):
            yield from _kinds(inner)
    elif annotation is not NoneType:
        yield annotation
