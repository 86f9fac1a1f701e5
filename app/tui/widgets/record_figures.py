"""Pictures of a run from its own record: the figures of its report, as far as it has come."""

from collections.abc import Callable
from pathlib import Path
from typing import Final

from textual.app import RenderResult
from textual.content import Content
from textual.events import Resize
from textual.widget import Widget

from catseye.app.tui.pictures import NOTHING, Painter, Pictures, Wanted
from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.frame_text import set_subtitle, set_title
from catseye.app.tui.widgets.inks import FIGURE_STYLES, painted

_READING: Final = "reading the record …"
_TITLE: Final = "From the record"

_SHARE: Final = 0.2
"""Of the time may go into looks: one takes as long as the record is."""

_AGAIN_S: Final = 5.0
"""Until pictures that are missing are tried again, if no longer was waited for them."""

_LATE_S: Final = 5.0
"""What has been drawn for longer is said to be late."""


class RecordFigures(Widget):
    """Figures of the run that is shown, drawn anew when a step is done: as many as have room, the others in turn.

    Args:
        painter: draws them.
        now_s: returns monotonic time, s.
    """

    DEFAULT_CSS = """
    RecordFigures { height: 1fr; padding: 0 1; }
    """

    def __init__(self, painter: Painter, now_s: Callable[[], float], *, id: str) -> None:
        super().__init__(id=id, classes="panel")
        set_title(self, _TITLE)
        self._painter = painter
        self._now_s = now_s
        self._run: RunState | None = None
        self._root = Path()
        self._seen: tuple[object, ...] = ()
        self._drawn: tuple[object, ...] = ()
        self._first = 0
        self._drawing = False
        self._next_s = 0.0
        self._began_s = 0.0
        self._looked = False
        self.pictures = Pictures(note=NOTHING)
        self._shown = _content(self.pictures)

    def render(self) -> RenderResult:
        """Return what was drawn last; put together once, however often the screen is painted."""
        return self._shown

    def show(self, run: RunState | None, root: Path) -> None:
        """Show what is known of a run.

        Args:
            run: that is shown; None before the first.
            root: folder of the runs; its own path is known only from its end on, or to clients that came later.
        """
        if (None if run is None else run.name) != (None if self._run is None else self._run.name):
            self._first, self._next_s, self._seen, self._looked = 0, 0.0, (), False
            self._take(Pictures(note=_READING if _done(run) else NOTHING))
        self._run, self._root = run, root
        self._draw_anew()

    def turn(self) -> None:
        """Begin with the next picture."""
        self._first = self.pictures.first + 1
        self._draw_anew()

    @property
    def at_the_last(self) -> bool:
        """No picture comes after the one that is shown first."""
        return self.pictures.first + 1 >= len(self.pictures.titles)

    def on_resize(self, _event: Resize) -> None:
        """Draw for another size."""
        self._draw_anew()

    def _draw_anew(self) -> None:
        """Have drawn what has changed: what the run holds, which picture comes first, the size."""
        run = self._run
        done = _done(run)
        if self._drawing and done:
            self._say_late()
        if run is None or self._drawing or not done:
            return
        seen = run.name, run.active, done
        look = seen != self._seen and self._now_s() >= self._next_s
        size = self.content_size
        drawn = self._first, size
        if not look and (drawn == self._drawn or not self._seen):
            return
        if look:
            self._seen = seen
        self._drawing, self._drawn, self._began_s = True, drawn, self._now_s()
        path = Path(run.path) if run.path else self._root / run.name
        wanted = Wanted(path, look, self._first, size.width, size.height)
        self.run_worker(self._draw(wanted, run.name), group="record", exit_on_error=False)

    async def _draw(self, wanted: Wanted, name: str) -> None:
        try:
            pictures = await self._painter.draw(wanted)
        finally:
            self._drawing = False
        # Another run may have begun meanwhile, which has to wait for nothing.
        if self._run is not None and self._run.name == name:
            self._plan_next(wanted, pictures)
            self._take(pictures)
        else:
            self._take(self.pictures)
        self._draw_anew()

    def _plan_next(self, wanted: Wanted, pictures: Pictures) -> None:
        """Note when the record may be looked at again."""
        now_s = self._now_s()
        taken_s = now_s - self._began_s
        if wanted.look:
            # The first one starts a process and reads all that there is: it says nothing of those to come.
            self._next_s = now_s + (taken_s * (1.0 - _SHARE) / _SHARE if self._looked else taken_s)
            self._looked = True
        if pictures.failed:
            # Without a further step, too: the run may have ended.
            self._seen, self._next_s = (), now_s + max(_AGAIN_S, taken_s)

    def _take(self, pictures: Pictures) -> None:
        if pictures != self.pictures:
            self.pictures, self._shown = pictures, _content(pictures)
            self.refresh()
        waiting = len(pictures.titles) - pictures.shown
        set_title(self, pictures.titles[pictures.first] if waiting else _TITLE)
        set_subtitle(self, f"{pictures.first + 1} of {len(pictures.titles)}, v: next" if waiting else "")

    def _say_late(self) -> None:
        """Say that what is shown is old, or that nothing is to be seen yet, and for how long."""
        waited_s = self._now_s() - self._began_s
        if waited_s >= _LATE_S:
            set_subtitle(self, f"being drawn anew for {waited_s:.0f} s")


def _content(pictures: Pictures) -> Content:
    if pictures.note:
        return Content.styled(pictures.note, "dim")
    return painted(pictures.lines, FIGURE_STYLES)


def _done(run: RunState | None) -> int:
    """Return how many steps are done."""
    return 0 if run is None else run.steps_done
