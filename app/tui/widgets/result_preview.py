"""What the result under the cursor comes to: its verdict, and its first figure."""

import asyncio
from typing import TYPE_CHECKING, Final

from textual.app import ComposeResult
from textual.containers import Vertical
from textual.content import Content
from textual.timer import Timer

from catseye.app.results.figures import Figure
from catseye.app.tui import result_shelf as shelf
from catseye.app.tui.widgets.figure_view import Figures
from catseye.app.tui.widgets.report_content import statement_content
from catseye.app.tui.widgets.static_text import StaticText, lines

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.results.model import Statement
    from catseye.app.tui.result_shelf import AnyFile

_RESTS_S: Final = 0.2
"""A result that the cursor only passes is not read."""

_SENTENCES: Final = 6


class ResultPreview(Vertical):
    """A result without opening it; nothing is done while there is no room for it."""

    DEFAULT_CSS = """
    ResultPreview { padding: 0 1; }
    ResultPreview #preview-text { height: auto; max-height: 40%; }
    """

    def __init__(self, *, id: str, classes: str) -> None:
        super().__init__(id=id, classes=classes)
        self._file: AnyFile | None = None
        self._timer: Timer | None = None

    def compose(self) -> ComposeResult:
        """Sentences and figure."""
        yield StaticText(id="preview-text")
        figures = Figures(id="preview-figures")
        figures.can_focus = False
        yield figures

    def show_soon(self, file: "AnyFile | None") -> None:
        """Show a result as soon as the cursor rests on it."""
        self._file = file
        if self._timer is not None:
            self._timer.stop()
        self._timer = self.set_timer(_RESTS_S, self._show)

    def on_resize(self) -> None:
        """Show what there was no room for before."""
        if self._file is not None:
            self.show_soon(self._file)

    def _show(self) -> None:
        if self.display and self._file is not None:
            self.run_worker(self._read(self._file), group="preview", exclusive=True, exit_on_error=False)

    async def _read(self, file: "AnyFile") -> None:
        said, figure = await asyncio.to_thread(_found, file)
        if file is self._file:
            shown = lines(*map(statement_content, said)) if said else Content.styled(file.fault, "$error")
            self.query_one("#preview-text", StaticText).set_text(shown)
            self.query_one(Figures).show(figure)


def _found(file: "AnyFile") -> "tuple[list[Statement], Figure | None]":
    """Return what a result says and its first figure; it may read further files, so call it in a thread."""
    if file.result is None:
        return [], None
    if (kind := shelf.report_kind(file)) is not None:
        report = kind.report(kind.files(file.path, file.result))
        figures = (block for block in report.blocks() if isinstance(block, Figure))
        return list(report.statements())[:_SENTENCES], next(figures, None)
    scaras = shelf.as_scaras(file)
    if scaras is None or scaras.result is None:
        return [], None
    from catseye.app.results.scara.figures.maps import map_figure
    from catseye.app.results.scara.result_report import residual_figures
    from catseye.app.tui.result_texts import fit_sentences

    figure = map_figure(scaras.result) or next(iter(residual_figures(scaras.result)), None)
    return fit_sentences(scaras.result, None)[:_SENTENCES], figure
