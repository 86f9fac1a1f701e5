"""Names of figures and texts in them stay texts, whatever they are."""

import re
from xml.etree import ElementTree

import pytest
from matplotlib.figure import Figure

from catseye.app.render.canvas import svg
from catseye.app.render.markup import element

NAMES = ['"><img src=x onerror=alert(1)>', r"pose\1", r"\g<2>", "a b", "\x1b]0;owned\x07", "反射"]


def drawing(name: str, text: str = "t") -> str:
    figure = Figure(figsize=(1.0, 1.0))
    figure.text(0.1, 0.1, text)
    return svg(figure, name, text)


@pytest.mark.parametrize("name", NAMES)
def test_names_inside_a_figure_are_words(name: str) -> None:
    root = ElementTree.fromstring(drawing(name))
    ids = [value for part in root.iter() if (value := part.get("id"))]
    assert ids
    assert all(re.fullmatch(r"[\w.-]+", value, re.ASCII) for value in ids)


def test_names_that_look_alike_stay_apart() -> None:
    assert drawing("a b") != drawing("a-b")


@pytest.mark.parametrize("text", ["\x1b]0;owned\x07", "a\0b", "\x0b"])
def test_control_characters_are_replaced(text: str) -> None:
    assert not re.search("[\x00-\x08\x0b-\x1f]", drawing("a", text))
    assert not re.search("[\x00-\x08\x0b-\x1f]", element("p", text, title=text))
