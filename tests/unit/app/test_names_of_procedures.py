"""The application finds what procedures declare, and names none of them."""

import ast
import re
from pathlib import Path

import pytest

from catseye import app
from catseye.app.protocol.procedures import procedure_names

APP = Path(app.__path__[0])

ALLOWED = {
    "results/scara": "the room of that system: its remedies name its procedures",
    "cell/scara": "the room of that system; a contributor to its budget has such a name",
    "cell/scara/template.py": "comments of the cell file of that system",
    "cell/wizard/scara": "questions about the cell file of that system",
    "cell/templates.py": "a system is called as its first procedure is",
    "cell/resolution": "comments of the cell file of that system",
    "cli/commands.py": "a command is called as the procedure whose runs it evaluates",
    "cli/resolution": "the room of that system, whose tests are called as the procedures are",
    "results/resolution": "the room of that system, whose tests are called as the procedures are",
    "tui/resolution": "as its results",
    "tui/screens/results.py": "identifiers of widgets",
    "tui/screens/setup.py": "identifiers of widgets",
}
"""Where a name may stand, and why; docstrings and the examples of help texts may name them anywhere."""


def strings(path: Path) -> list[str]:
    """Return the string constants of a module without its docstrings."""
    tree = ast.parse(path.read_text("utf-8"))
    docs = {
        id(node.value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
    }
    constants = (node for node in ast.walk(tree) if isinstance(node, ast.Constant))
    return [node.value for node in constants if isinstance(node.value, str) and id(node) not in docs]


def is_named(name: str, text: str) -> bool:
    """Return whether a text names a procedure; words of plain English are names only by themselves."""
    if "-" in name:
        return re.search(rf"(?<![\w-]){name}(?![\w-]| tracking)|_{name}_", text) is not None
    return text == name or re.search(rf"\brun {name}\b", text) is not None


def allowed(path: Path) -> bool:
    return any(path.relative_to(APP).as_posix().startswith(place) for place in ALLOWED)


@pytest.mark.parametrize("name", procedure_names())
def test_no_procedure_is_named_in_the_application(name: str) -> None:
    modules = [path for path in sorted(APP.rglob("*.py")) if not allowed(path)]
    assert len(modules) > 200
    named = [str(path) for path in modules if any(is_named(name, text) for text in strings(path))]
    assert not named


@pytest.mark.parametrize("text", ['"open-loop"', "_validation-path_", "catseye run beam-level --cell"])
def test_a_name_is_recognised(text: str) -> None:
    assert any(is_named(name, text) for name in procedure_names())


def test_phrases_of_the_field_are_no_names() -> None:
    texts = ("Robot error maps by open-loop tracking", "repeatability of the robot")
    assert not any(is_named(name, text) for name in procedure_names() for text in texts)
