"""docs/architecture.md draws the house as it stands, and names nothing that is not there."""

import importlib
import re
import tomllib
from graphlib import CycleError
from itertools import combinations
from typing import Any

import pytest

from tests.unit.rooms import PAGE, ROOT, SOURCE, TOPS, drawing, imported, permitted, room_of

TEXT = PAGE.read_text("utf-8")
NAMES = sorted(set(re.findall(rf"`((?:{'|'.join(TOPS)}|tests)(?:\.\w+)+)(?:\(\))?`", TEXT)))
PATHS = sorted(set(re.findall(rf"`((?:{'|'.join(TOPS)}|tests|docs)/[\w./*-]*)`", TEXT)))
APP = "catseye.app"


def contracts(kind: str) -> list[dict[str, Any]]:
    read = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))
    return [each for each in read["tool"]["importlinter"]["contracts"] if each["type"] == kind]


def within(room: str, module: str) -> bool:
    return f"catseye.{room}.".startswith(f"{module}.")


def found(name: str) -> object:
    """Return what a dotted name stands for."""
    parts = name.split(".") if name.startswith("tests.") else ["catseye", *name.split(".")]
    for length in range(len(parts), 0, -1):
        try:
            thing: object = importlib.import_module(".".join(parts[:length]))
        except ModuleNotFoundError:
            continue
        for part in parts[length:]:
            thing = getattr(thing, part)
        return thing
    raise LookupError(name)


def test_a_room_imports_only_what_the_table_permits() -> None:
    allowed = permitted()
    extra = {room: others - allowed[room] for room, others in imported().items() if others - allowed[room]}
    assert not extra


@pytest.mark.parametrize("top", ["app", "calibration", "procedures"])
def test_every_folder_is_a_room_of_the_table(top: str) -> None:
    folders = {f"{top}.{path.parent.name}" for path in (SOURCE / top).glob("*/__init__.py")}
    assert folders
    assert folders <= permitted().keys()


def test_permitted_imports_go_down_the_table_only() -> None:
    order = list(permitted())
    upward = [(a, b) for a, others in permitted().items() for b in others if order.index(b) <= order.index(a)]
    assert len(order) > 20
    assert not upward


def test_the_drawing_is_that_of_the_code() -> None:
    (drawn,) = re.findall(r"```mermaid\n(.*?)\n```", TEXT, re.DOTALL)
    assert drawn == drawing(imported()), "python -m tests.unit.rooms draws it again"


def test_the_table_permits_nothing_that_a_contract_forbids() -> None:
    allowed = permitted()
    wrong = [
        (room, other, contract["name"])
        for contract in contracts("forbidden")
        if not contract.get("ignore_imports")
        for room, others in allowed.items()
        for other in others
        if any(within(room, source) for source in contract["source_modules"])
        and any(within(other, target) for target in contract["forbidden_modules"])
    ]
    assert not wrong


def test_the_table_keeps_to_the_layers_of_the_application() -> None:
    allowed = permitted()
    for contract in contracts("layers"):
        if contract["containers"] != [APP]:
            continue
        layers = [[f"app.{name}" for name in layer.split(" | ")] for layer in contract["layers"]]
        rooms = [[name for name in layer if name in allowed] for layer in layers]
        for upper, lower in combinations(rooms, 2):
            assert not [(b, a) for a in upper for b in lower if a in allowed[b]]


def test_a_circle_is_not_drawn() -> None:
    with pytest.raises(CycleError):
        drawing({"a": frozenset("b"), "b": frozenset("a")})


def test_an_arrow_that_follows_from_others_is_not_drawn() -> None:
    assert drawing({"a": frozenset("bc"), "b": frozenset("c"), "c": frozenset()}).splitlines()[1:] == [
        "    a --> b",
        "    b --> c",
    ]


def test_a_module_outside_the_rooms_is_an_error() -> None:
    with pytest.raises(LookupError, match="no room"):
        room_of("cellar.wine", {"app": None})


@pytest.mark.parametrize("name", NAMES)
def test_a_name_of_the_page_exists(name: str) -> None:
    assert found(name)


@pytest.mark.parametrize("path", PATHS)
def test_a_path_of_the_page_exists(path: str) -> None:
    assert [*ROOT.glob(path), *SOURCE.glob(path)]
