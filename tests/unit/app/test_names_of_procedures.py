"""The application finds what procedures declare, and names none of them."""

import ast
import re
from functools import cache
from pathlib import Path

import pytest

from catseye import app
from catseye.app.protocol.installed import procedure_names

APP = Path(app.__path__[0])

ALLOWED = {
    "engine/walked/register.py": "one section of a cell file is called ballbar",
    "engine/simulated_operator.py": "one request of the control port is called ballbar",
    "results/scara": "remedies of this system say which procedure to run",
    "cell/scara": "its cell file and the contributors to its budget say which procedure gives a value",
    "cell/wizard/scara": "questions about its cell file say which procedure gives a value",
    "cell/wizard/pages.py": "one page of the wizard is called as the section of the cell file, ballbar",
    "cell/wizard/six_axis": "questions about its cell file say which procedure gives a value",
    "cell/templates.py": "templates are found by the name of their system; one system is called resolution",
    "cell/resolution": "comments of its cell file say which procedure needs an entry",
    "campaign/words.py": "one command on stored data is called resolution",
    "cli/commands.py": "one command is called resolution",
    "cli/outputs.py": "one output is called resolution",
    "cli/demo.py": "one system is called resolution",
    "cli/serial_arm/demo.py": "the runs of the demonstration, with parameters of their own",
    "cli/resolution": "options and results tell its tests apart by the procedures' names",
    "results/serial_arm/ballbar_report.py": "a table of records and a section are called as the instrument is",
    "results/resolution": "results tell its tests apart by the procedures' names",
    "tui/resolution": "views tell its tests apart by the procedures' names",
    "tui/screens/shown_results.py": "one widget is called resolution",
    "tui/screens/setup.py": "one system is called resolution",
}
"""Where a name may stand, and why; docstrings and the examples of help texts may name them anywhere."""


def strings(path: Path) -> list[str]:
    """Return the string constants of a module without its docstrings."""
    nodes = list(ast.walk(ast.parse(path.read_text("utf-8"))))
    docs = {
        id(node.value)
        for node in nodes
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    constants = (node for node in nodes if isinstance(node, ast.Constant))
    return [node.value for node in constants if isinstance(node.value, str) and id(node) not in docs]


def is_named(name: str, text: str) -> bool:
    """Return whether a text names a procedure; words of plain English are names only by themselves."""
    if name not in text:
        return False
    if "-" in name:
        return re.search(rf"(?<![\w-]){name}(?![\w-]| tracking)|_{name}_", text) is not None
    return text == name or re.search(rf"\brun {name}\b", text) is not None


def names_in(path: Path) -> set[str]:
    texts = strings(path)
    return {name for name in procedure_names() if any(is_named(name, text) for text in texts)}


@cache
def named() -> dict[str, set[str]]:
    """Return what each module of the application names."""
    modules = {path.relative_to(APP).as_posix(): names_in(path) for path in sorted(APP.rglob("*.py"))}
    assert len(modules) > 200
    return modules


def test_no_procedure_is_named_in_the_application() -> None:
    assert [place for place, names in named().items() if names and not place.startswith(tuple(ALLOWED))] == []


@pytest.mark.parametrize("allowed", ALLOWED)
def test_each_place_allowed_to_name_procedures_does(allowed: str) -> None:
    assert any(names for place, names in named().items() if place.startswith(allowed))


@pytest.mark.parametrize("text", ['"open-loop"', "_validation-path_", "catseye run beam-level --cell"])
def test_a_name_is_recognised(text: str) -> None:
    assert any(is_named(name, text) for name in procedure_names())


def test_phrases_of_the_field_are_no_names() -> None:
    texts = ("Robot error maps by open-loop tracking", "repeatability of the robot")
    assert not any(is_named(name, text) for name in procedure_names() for text in texts)
