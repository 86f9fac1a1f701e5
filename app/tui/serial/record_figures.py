"""Pictures of a run under way from its own record: the figures of its report, as far as it has come."""

import asyncio
from pathlib import Path
from typing import TYPE_CHECKING, Final

from textual.app import ComposeResult
from textual.containers import Vertical
from textual.content import Content

from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.figure_view import Figures, FigureView
from catseye.app.tui.widgets.static_text import StaticText

if TYPE_CHECKING:
    # matplotlib's part and numpy are not loaded before the first screen is painted.
    from catseye.app.results.figures import Figure


_NOTHING: Final = "nothing measured yet"
_READING: Final = "reading the record …"

_PARTS: Final = 25


class RecordFigures(Vertical):
    """Figures of the run that is shown, read anew each time another step is done."""

    DEFAULT_CSS = """
    RecordFigures { height: 1fr; }
    RecordFigures #record-note { height: auto; padding: 0 1; }
    """

    def __init__(self, *, id: str) -> None:
        super().__init__(id=id, classes="panel")
        self.border_title = "From the record"
        self._of: tuple[object, ...] = ()

    def compose(self) -> ComposeResult:
        """Put the parts together."""
        yield StaticText(id="record-note")
        yield Figures()

    def show(self, run: RunState | None, root: Path) -> None:
        """Show what is known of a run; reading goes on in a thread.

        Args:
            run: that is shown; None before the first.
            root: folder of the runs; its own path is known only from its end on, or to clients that came later.
        """
        done = 0 if run is None else sum(step.status == "done" for step in run.steps.values())
        key = (None if run is None else (run.name, run.active), _read_at(done))
        if key == self._of:
            return
        self._of = key
        if run is None or not done:
            self._shown((), _NOTHING)
            return
        if not self.query_one(FigureView).figures:
            self._shown((), _READING)
        path = Path(run.path) if run.path else root / run.name
        self.run_worker(self._read(path), group="record", exclusive=True, exit_on_error=False)

    async def _read(self, path: Path) -> None:
        from catseye.app.errors import CatseyeError

        try:
            figures = await asyncio.to_thread(_figures, path)
        except CatseyeError as error:
            self._shown((), str(error))
            return
        self._shown(figures, "" if figures else _NOTHING)

    def _shown(self, figures: "tuple[Figure, ...]", note: str) -> None:
        text = self.query_one("#record-note", StaticText)
        text.set_text(Content.styled(note, "dim"))
        text.display = bool(note)
        view = self.query_one(Figures)
        view.display = bool(figures)
        view.show(*figures)


def _read_at(done: int) -> int:
    """Return with which number of steps a record is read: with each at first, later as it grows by a 25th.

    A reading takes as long as the record is; with each of 1000 poses the readings would take more than the run.
    """
    return done if done < 2 * _PARTS else done - done % (done // _PARTS)


def _figures(path: Path) -> "tuple[Figure, ...]":
    """Return the figures of a run's report; it opens files, so call it in a thread.

    Raises:
        StorageError: the record cannot be read.
    """
    from catseye.app.results.figures import Figure
    from catseye.app.results.found import found_sections
    from catseye.app.store.reader import RunReader

    found = found_sections(RunReader(path))
    return tuple(block for one in found for block in one.blocks if isinstance(block, Figure))
