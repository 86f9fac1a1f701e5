"""Installed drivers by what they drive, with what each is for, and the settings that each has."""

from collections.abc import Iterator
from functools import cache
from types import NoneType, UnionType
from typing import Any, Literal, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from catseye.app.cell.axes import robot_driver
from catseye.app.cell.wizard.question import Choice, Question, text_of
from catseye.drivers.roles.device import DriverClass, Role
from catseye.drivers.roles.registry import working_drivers


@cache
def drivers_of(role: Role) -> tuple[Choice, ...]:
    """Return the installed drivers of a role."""
    return tuple(Choice(name, driver.summary) for name, driver in _installed() if driver.role == role)


def further_endpoint_of(driver: str) -> str:
    """Return the key of [robot] with the further endpoint of a robot's driver; empty for none."""
    known = {choice.value for choice in drivers_of("robot")}
    return robot_driver(driver).abilities.further_endpoint if driver in known else ""


def has_setting(driver: str, name: str) -> bool:
    """Return whether an installed driver has a setting of this name."""
    found = dict(_installed()).get(driver)
    return found is not None and name in found.Settings.model_fields


def setting_questions(section: str, driver: str, without: frozenset[str]) -> tuple[Question, ...]:
    """Return a question for each setting of a driver, from the driver's own model.

    Args:
        driver: its name; none that is installed has no settings.
        without: settings that have questions of their own.
    """
    model = dict(_installed())[driver].Settings if driver in dict(_installed()) else None
    if model is None:
        return ()
    asked = (
        _question(section, name, field) for name, field in model.model_fields.items() if name not in without
    )
    return tuple(question for question in asked if question is not None)


@cache
def _installed() -> tuple[tuple[str, type[DriverClass]], ...]:
    return tuple(working_drivers().items())


def _question(section: str, name: str, field: FieldInfo) -> Question | None:
    key, words = f"{section}.settings.{name}", field.description or ""
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
