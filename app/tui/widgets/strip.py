"""The beam's displacement as it came in the last seconds."""

import math
from itertools import islice
from typing import TYPE_CHECKING, Final

from textual.app import RenderResult
from textual.content import Content
from textual.widget import Widget

from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.widgets.inks import Line, painted
from catseye.app.tui.widgets.status_bar import STALE_S, age_style

if TYPE_CHECKING:
    # numpy is not loaded before the first screen is painted.
    from catseye.app.tui.widgets.braille import Floats
    from catseye.app.tui.widgets.strip_chart import Scale

WINDOWS_S: Final = (10, 30, 60)
"""Lengths of the strip that can be chosen, s."""

_STYLES: Final = {"trace": "$success", "axis": "dim"}
_OWN_LINES: Final = 2
"""Lines that are no chart: what the numbers are, and the time."""


class Strip(Widget):
    """A strip chart of the beam's displacement; every column reaches from the smallest to the largest sample."""

    DEFAULT_CSS = """
    Strip { height: 1fr; min-height: 4; text-wrap: nowrap; text-overflow: ellipsis; }
    """

    def __init__(self) -> None:
        super().__init__()
        self.window_s: float = WINDOWS_S[0]
        self._shown = Content("")
        self._scale: Scale | None = None
        self._last: tuple[EngineState, float] | None = None

    @property
    def scale(self) -> "Scale | None":
        """The upright axis; None before the first sample."""
        return self._scale

    @property
    def shown(self) -> Content:
        """What is painted."""
        return self._shown

    def next_window(self) -> None:
        """Show another length of time."""
        later = [each for each in WINDOWS_S if each > self.window_s]
        self.window_s = later[0] if later else WINDOWS_S[0]

    def show(self, engine: EngineState, now_s: float) -> None:
        """Show the samples that came."""
        self._last = engine, now_s
        shown = self._drawn(engine, now_s)
        if not shown.is_same(self._shown):
            self._shown = shown
            self.refresh()

    def on_resize(self) -> None:
        """Fill the new size."""
        if self._last is not None:
            self.show(*self._last)

    def render(self) -> RenderResult:
        """Return the chart."""
        return self._shown

    def _drawn(self, engine: EngineState, now_s: float) -> Content:
        if not engine.strip:
            return Content.styled("no sample of the beam yet", "dim")
        from catseye.app.tui.widgets import strip_chart

        dots, rows = strip_chart.dots_of(self.size.width), self.size.height - _OWN_LINES
        if dots <= 0 or rows <= 0:
            return Content("")
        per_dot = max(1, math.ceil(self.window_s / engine.strip_period_s / dots))
        low_mm, high_mm = _folded(engine, per_dot, dots)
        lowest_mm, highest_mm = _extremes(low_mm, high_mm)
        self._scale = strip_chart.next_scale(self._scale, lowest_mm, highest_mm)
        if self._scale is None:
            return Content.styled("no beam in the last seconds", "dim")
        since_s = now_s - engine.strip_at_s
        chart = strip_chart.draw(low_mm, high_mm, self._scale, self.size.width, rows)
        span_s = per_dot * dots * engine.strip_period_s
        return painted(
            [
                [(self._scale.title + age_style(0.0, since_s)[1], "axis")],
                *chart,
                _time_line(span_s, highest_mm - lowest_mm, self.size.width),
            ],
            _STYLES,
            faded=since_s > STALE_S,
        )


def _folded(engine: EngineState, per_dot: int, dots: int) -> "tuple[Floats, Floats]":
    from catseye.app.tui.widgets.strip_chart import arrays, fold

    wanted = min(per_dot * dots, len(engine.strip))
    newest = list(islice(reversed(engine.strip), wanted))[::-1]
    low_mm, high_mm = arrays([each.low_mm for each in newest], [each.high_mm for each in newest])
    return fold(low_mm, high_mm, engine.strip_seen, per_dot, dots)


def _extremes(low_mm: "Floats", high_mm: "Floats") -> tuple[float, float]:
    import numpy as np

    return float(np.fmin.reduce(low_mm)), float(np.fmax.reduce(high_mm))


def _time_line(span_s: float, range_mm: float, width: int) -> Line:
    """Say how long ago the trace begins, and how far apart its extremes lie."""
    from catseye.app.tui.widgets.strip_chart import LABEL_WIDTH

    left, extent = " " * LABEL_WIDTH + f"−{span_s:.3g} s", f" range {1e3 * range_mm:.1f} µm "
    room = width - len(left) - len("now")
    shown = extent if math.isfinite(range_mm) and len(extent) <= room else ""
    return [(left + shown.center(max(room, 1)) + "now", "axis")]
