"""A drawing that fills its place, whatever size that has."""

from collections.abc import Callable
from typing import Final

from textual.app import RenderResult
from textual.content import Content
from textual.widget import Widget

from catseye.app.tui.widgets.inks import Line, painted

_STYLES: Final = {
    "axis": "$foreground-muted",
    "up": "$primary bold",
    "down": "$accent bold",
    "dots": "$foreground",
    "outlier": "$error bold",
    "first-model": "$secondary bold",
    "last-model": "$success bold",
    "limit": "$warning",
}

Draw = Callable[[int, int], list[Line]]
"""Returns lines for a width and a height in cells."""


class Drawing(Widget):
    """Drawn anew only for another size or another content."""

    DEFAULT_CSS = """
    Drawing { height: 1fr; width: 1fr; min-height: 4; }
    """

    def __init__(self, *, id: str | None = None, classes: str | None = None) -> None:
        super().__init__(id=id, classes=classes)
        self._draw: Draw | None = None
        self._drawn_at = (0, 0)
        self._content = Content("")

    def show(self, draw: Draw | None) -> None:
        """Show a drawing, or nothing."""
        self._draw, self._drawn_at = draw, (0, 0)
        self._content = Content("")
        self.refresh()

    def render(self) -> RenderResult:
        """Return the drawing at this size."""
        size = self.size.width, self.size.height
        if self._draw is not None and size != self._drawn_at and all(size):
            self._content, self._drawn_at = painted(self._draw(*size), _STYLES), size
        return self._content
