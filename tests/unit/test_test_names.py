"""Test names say one behaviour in at most ten words."""

import ast
from pathlib import Path

TESTS = Path(__file__).parents[1]
MOST_WORDS = 10


def test_no_test_name_has_more_than_ten_words() -> None:
    names = [
        node.name
        for path in TESTS.rglob("*.py")
        for node in ast.walk(ast.parse(path.read_text("utf-8")))
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef) and node.name.startswith("test_")
    ]
    assert len(names) > 1000
    assert [name for name in names if len(name.split("_")) - 1 > MOST_WORDS] == []
