"""What the tests of the terminal interface share."""

from collections.abc import Iterator
from typing import Any

import pytest
from textual.css.model import RuleSet
from textual.css.stylesheet import Stylesheet

from tests.unit.app.tui.idle import loop_says_when_idle


@pytest.fixture(scope="session", autouse=True)
def styles_are_parsed_once() -> Iterator[None]:
    """Keep what was parsed of a style sheet for the next program: hundreds of them parse the same texts."""
    parse = Stylesheet._parse_rules  # noqa: SLF001  # Textual keeps it as long as one program lives
    known: dict[tuple[Any, ...], list[RuleSet]] = {}

    def parse_once(self: Stylesheet, *text: Any, **about: Any) -> list[RuleSet]:
        colours = frozenset(self._variables.items())  # a theme is part of what is parsed
        key = (colours, text, frozenset(about.items()))
        if key not in known:
            known[key] = parse(self, *text, **about)
        return known[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(Stylesheet, "_parse_rules", parse_once)
        yield


@pytest.fixture(scope="session", autouse=True)
def keys_take_no_longer_than_their_work() -> Iterator[None]:
    """Have the event loop say when a key was dealt with."""
    with loop_says_when_idle():
        yield
