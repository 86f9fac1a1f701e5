"""The stages of a cell's way as lines of text."""

from collections.abc import Iterable
from typing import Final

from textual.content import Content

from catseye.app.results.readiness.stages import CellStage
from catseye.app.tui.widgets.static_text import lines

_SIGNS: Final = {"done": "✓", "next": "→", "later": "·", "left out": "–"}
_STYLES: Final = {"done": "$success", "next": "bold $primary", "left out": "dim"}


def way_content(stages: Iterable[CellStage]) -> Content:
    """Return a line for each stage, with a sign for how far it is."""
    return lines(
        *(Content.styled(f"{_SIGNS[one.state]} {one.name}", _STYLES.get(one.state, "")) for one in stages)
    )
