"""Whatever texts a result holds, its page shows them and runs none of them."""

import copy
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from catseye.app.cli.report import report
from catseye.app.errors import CatseyeError
from tests.fuzz.amount import FILES
from tests.fuzz.files import KINDS

HOSTILE = "<script>alert(1)</script>\"'><img src=x onerror=alert(1)>&lt;$\\frac{$[/x]\x1b]0;owned\x07"
RESULTS = ("result of six axes", "result of motion resolution", "result of a SCARA")[
    : 3 if FILES > 100 else 1
]
"""The figures of the others take long to draw; `make campaign-access` draws them."""

Place = tuple[str | int, ...]


def texts_in(value: Any, place: Place = ()) -> Iterator[Place]:
    match value:
        case dict():
            for key, each in value.items():
                yield from texts_in(each, (*place, key))
        case list():
            for number, each in enumerate(value[:2]):
                yield from texts_in(each, (*place, number))
        case str():
            yield place


def put(document: Any, place: Place, text: str) -> Any:
    changed = copy.deepcopy(document)
    inner = changed
    for part in place[:-1]:
        inner = inner[part]
    inner[place[-1]] = text
    return changed


def all_hostile(name: str, path: Path) -> int:
    """Write a result in which every text is hostile that may be any text; return how many are."""
    kind = KINDS[name]
    document, found = json.loads(kind.make(path.parent)), 0
    for place in texts_in(document):
        changed = put(document, place, HOSTILE)
        path.write_text(json.dumps(changed), "utf-8")
        try:
            kind.read(path)
        except CatseyeError:
            continue
        document, found = changed, found + 1
    path.write_text(json.dumps(document), "utf-8")
    return found


@pytest.mark.parametrize("name", RESULTS)
def test_no_text_of_a_result_becomes_markup(name: str, tmp_path: Path) -> None:
    path, page = tmp_path / KINDS[name].name, tmp_path / "page.html"
    assert all_hostile(name, path) > 2
    report([str(path)], page)
    text = page.read_text("utf-8")
    assert "&lt;script&gt;alert(1)&lt;/script&gt;" in text
    assert "<script>alert" not in text
    assert "<img src=x" not in text
    assert "\x1b" not in text
