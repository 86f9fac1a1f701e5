"""Progress with an estimate of the time that is left, on stderr."""

import shutil
import sys
import time
from collections.abc import Callable
from functools import partial

from catseye.app.cli.event_channel import report_progress
from catseye.app.cli.output import talk
from catseye.app.results.numbers import duration_text

_BAR = 30
_REDRAW_S = 0.1
_PLAIN_EVERY = 0.1


class ProgressBar:
    """A bar that is redrawn on a terminal, and a line for each tenth where stderr is a file.

    Args:
        wall_clock: monotonic seconds of real time.
        heard: somebody has to be there to read it; see `talk`.
    """

    def __init__(
        self, title: str, wall_clock: Callable[[], float] = time.monotonic, *, heard: bool = False
    ) -> None:
        self._title = title
        self._talk = partial(talk, heard=heard)
        self._clock = wall_clock
        self._start_s = wall_clock()
        self._drawn_s = -1.0
        self._written = 0.0
        self._live = sys.stderr.isatty()
        self._open = False

    def update(self, done: float, total: float, text: str) -> None:
        """Show how far it is; the time that is left follows from the share done so far."""
        share = min(1.0, done / total) if total > 0.0 else 1.0
        now = self._clock()
        elapsed_s = now - self._start_s
        left_s = elapsed_s / share - elapsed_s if share > 0.01 else None
        left = "?" if left_s is None else duration_text(left_s, whole=True)
        line = f"{share:4.0%}  {duration_text(elapsed_s, whole=True)} gone, {left} left  {text}"
        redraw = now - self._drawn_s > _REDRAW_S or share == 1.0
        if redraw:
            report_progress(self._title, share, elapsed_s, left_s, text)
            self._drawn_s = now
        if self._live and redraw:
            filled = round(_BAR * share)
            self._talk(f"\r\x1b[K{self._title} [{'#' * filled}{'.' * (_BAR - filled)}] {line}")
            self._open = True
        elif not self._live and (
            share >= self._written + _PLAIN_EVERY or (share == 1.0 and self._written < 1.0)
        ):
            self._talk(f"{self._title} {line}\n")
            self._written = share

    def hint(self, done: float, total: float, text: str) -> None:
        """Show how far something is that takes seconds: to programs and on a terminal; a file has no line of it.

        Its parts take so different times that no time left follows from them.
        """
        report_progress(self._title, done / total, self._clock() - self._start_s, None, text)
        if self._live:
            self.note(f"{self._title}: {text}")

    def note(self, text: str) -> None:
        """Show a line that is redrawn, on a terminal, in place of the bar."""
        self._talk(f"\r\x1b[K{text[: max(20, shutil.get_terminal_size().columns - 1)]}")
        self._open = True

    def close(self) -> None:
        """Leave the line."""
        if self._open:
            self._talk("\n")
            self._open = False
