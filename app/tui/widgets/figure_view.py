"""Figures of a report on the screen."""

from typing import Final

from textual.app import ComposeResult, RenderResult
from textual.containers import VerticalScroll
from textual.content import Content
from textual.geometry import Size
from textual.widget import Widget

from catseye.app.results.figures import Figure
from catseye.app.tui.widgets.inks import FIGURE_STYLES, painted

_WIDE: Final = 84
"""Figures that would be narrower stand below each other."""


class FigureView(Widget):
    """Figures beside each other where there is room, each as high as the place where it is seen, or as it needs."""

    DEFAULT_CSS = """
    FigureView { height: auto; width: 1fr; }
    """

    def __init__(self) -> None:
        super().__init__()
        self._figures: tuple[Figure, ...] = ()
        self._drawn_at: tuple[int, int] | None = None
        self._content = Content("")

    @property
    def figures(self) -> tuple[Figure, ...]:
        """What is shown."""
        return self._figures

    def show(self, figures: tuple[Figure, ...]) -> None:
        """Show figures instead of those before."""
        self._figures, self._drawn_at = figures, None
        self.refresh(layout=True)

    def get_content_height(self, container: Size, _viewport: Size, width: int) -> int:
        """Return the height of all figures."""
        return sum(rows for _, rows in self._rows(width, container.height))

    def render(self) -> RenderResult:
        """Return the figures at this size; drawn anew only for another size or other figures."""
        size = self.size.width, self.size.height
        if size != self._drawn_at:
            self._content, self._drawn_at = self._drawn(*size), size
        return self._content

    def _drawn(self, width: int, height: int) -> Content:
        from catseye.app.tui.widgets.figure_drawing import draw_beside

        seen = self.parent.size.height if isinstance(self.parent, Widget) else height
        lines = [
            line for figures, rows in self._rows(width, seen) for line in draw_beside(figures, width, rows)
        ]
        return painted(lines, FIGURE_STYLES)

    def _rows(self, width: int, seen: int) -> list[tuple[tuple[Figure, ...], int]]:
        """Return the figures that stand beside each other, and their height."""
        # Mathematics are imported with the first figure, not with the first screen.
        if not self._figures:
            return []
        from catseye.app.tui.widgets.figure_drawing import rows_needed_beside

        most = max(width // _WIDE, 1)
        parts = [self._figures[first : first + most] for first in range(0, len(self._figures), most)]
        return [(part, max(rows_needed_beside(part, width), seen)) for part in parts]


class Figures(VerticalScroll):
    """Figures that can be scrolled."""

    DEFAULT_CSS = """
    Figures { height: 1fr; width: 1fr; padding: 0 1; scrollbar-size-vertical: 1; }
    """

    def compose(self) -> ComposeResult:
        """All figures in one view."""
        yield FigureView()

    def show(self, *figures: Figure | None) -> None:
        """Show the figures that there are, from the first one on."""
        self.query_one(FigureView).show(tuple(figure for figure in figures if figure is not None))
        self.scroll_home(animate=False)
