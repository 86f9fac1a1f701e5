"""The beam's displacement as it came in the last seconds, or the angle that it stands for."""

import math
from itertools import islice
from typing import TYPE_CHECKING, Final

from textual.app import RenderResult
from textual.content import Content
from textual.widget import Widget

from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.widgets.inks import Line, painted
from catseye.app.tui.widgets.status_bar import STALE_S, age_style, is_dead
from catseye.procedures.kit.angular_optics import angle_deg

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
    """A strip chart of the beam's displacement; every column reaches from the smallest to the largest sample.

    Attributes:
        window_s: its length, s.
        spacing_mm: of the angular optics whose angle is shown; None shows the displacement.
    """

    DEFAULT_CSS = """
    Strip { height: 1fr; min-height: 4; text-wrap: nowrap; text-overflow: ellipsis; }
    """

    def __init__(self) -> None:
        super().__init__()
        self.window_s: float = WINDOWS_S[0]
        self.spacing_mm: float | None = None
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
            return Content.styled("no reading of the beam yet", "dim")
        from catseye.app.tui.widgets import strip_chart

        dots, rows = strip_chart.dots_of(self.size.width), self.size.height - _OWN_LINES
        if dots <= 0 or rows <= 0:
            return Content("")
        per_dot = max(1, math.ceil(self.window_s / engine.strip_period_s / dots))
        low, high = _folded(engine, per_dot, dots, self.spacing_mm)
        unit = strip_chart.MM if self.spacing_mm is None else strip_chart.DEG
        lowest, highest = _extremes(low, high)
        self._scale = strip_chart.next_scale(self._scale, lowest, highest, unit)
        if self._scale is None:
            return Content.styled("no beam in the last seconds", "dim")
        since_s = now_s - engine.strip_at_s
        chart = strip_chart.draw(low, high, self._scale, self.size.width, rows)
        span_s = per_dot * dots * engine.strip_period_s
        extent = f" range {1e3 * (highest - lowest):.{unit.digits}f} {unit.fine} "
        return painted(
            [
                [(self._scale.title + age_style(0.0, since_s)[1], "axis")],
                *chart,
                _time_line(span_s, extent if math.isfinite(highest - lowest) else "", self.size.width),
            ],
            _STYLES,
            faded=since_s > STALE_S or _is_away(engine),
        )


def _is_away(engine: EngineState) -> bool:
    """Return whether no beam returns now: what is drawn then is of before."""
    beam = None if engine.bench is None else engine.bench.beam
    return beam is not None and (not beam.beam_ok or is_dead(engine.bench, "interferometer"))


def _folded(
    engine: EngineState, per_dot: int, dots: int, spacing_mm: float | None
) -> "tuple[Floats, Floats]":
    from catseye.app.tui.widgets.strip_chart import arrays, fold

    wanted = min(per_dot * dots, len(engine.strip))
    newest = list(islice(reversed(engine.strip), wanted))[::-1]
    low, high = arrays(
        [_in_unit(each.low_mm, spacing_mm) for each in newest],
        [_in_unit(each.high_mm, spacing_mm) for each in newest],
    )
    return fold(low, high, engine.strip_seen, per_dot, dots)


def _in_unit(value_mm: float | None, spacing_mm: float | None) -> float | None:
    return value_mm if value_mm is None or spacing_mm is None else angle_deg(value_mm, spacing_mm)


def _extremes(low: "Floats", high: "Floats") -> tuple[float, float]:
    import numpy as np

    return float(np.fmin.reduce(low)), float(np.fmax.reduce(high))


def _time_line(span_s: float, extent: str, width: int) -> Line:
    """Say how long ago the trace begins, and how far apart its extremes lie."""
    from catseye.app.tui.widgets.strip_chart import LABEL_WIDTH

    left = " " * LABEL_WIDTH + f"−{span_s:.3g} s"
    room = width - len(left) - len("now")
    shown = extent if len(extent) <= room else ""
    return [(left + shown.center(max(room, 1)) + "now", "axis")]
