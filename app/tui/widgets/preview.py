"""What stands in the row under the cursor, without opening it: what it comes to, and its figures."""

from collections.abc import Callable
from typing import Final

from textual.app import ComposeResult
from textual.containers import Vertical
from textual.timer import Timer

from catseye.app.tui.aside import read_aside
from catseye.app.tui.previewed import Previewed
from catseye.app.tui.widgets.figure_view import Figures
from catseye.app.tui.widgets.report_content import statement_content
from catseye.app.tui.widgets.static_text import StaticText, lines

RESTS_S: Final = 0.2
"""A row that the cursor only passes is not read."""


class Preview(Vertical):
    """Sentences and figures beside a table; nothing is read while there is no room for it."""

    DEFAULT_CSS = """
    Preview { padding: 0 1; }
    Preview #preview-text { height: auto; max-height: 40%; }
    Preview.alone #preview-text { max-height: 100%; }
    Preview.alone #preview-figures { display: none; }
    """

    def __init__(self, *, id: str, classes: str) -> None:
        super().__init__(id=id, classes=classes)
        self._read: Callable[[], Previewed] | None = None
        self._timer: Timer | None = None

    def compose(self) -> ComposeResult:
        """Sentences and figures."""
        yield StaticText(id="preview-text")
        figures = Figures(id="preview-figures")
        figures.can_focus = False
        yield figures

    def show_soon(self, read: Callable[[], Previewed] | None) -> None:
        """Show a row as soon as the cursor rests on it.

        Args:
            read: finds what to show, in a thread; None where there is no row.
        """
        self._read = read
        if self._timer is not None:
            self._timer.stop()
        self._timer = self.set_timer(RESTS_S, self._look)

    def on_resize(self) -> None:
        """Show what there was no room for before."""
        self.show_soon(self._read)

    def _look(self) -> None:
        if self._read is None:
            self._show(Previewed())
        elif self.display:
            self.run_worker(self._found(self._read), group="preview", exclusive=True, exit_on_error=False)

    async def _found(self, read: Callable[[], Previewed]) -> None:
        found = await read_aside(read)
        if read is self._read:
            self._show(found)

    def _show(self, found: Previewed) -> None:
        self.query_one("#preview-text", StaticText).set_text(lines(*map(statement_content, found.said)))
        self.set_class(not found.figures, "alone")
        self.query_one(Figures).show(*found.figures)
