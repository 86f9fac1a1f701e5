"""A small plot of a run: the values that are watched, as they come in, with their band."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from textual.app import RenderResult
from textual.content import Content
from textual.widget import Widget

from catseye.app.tui.run_state import LiveValue, RunState
from catseye.app.tui.widgets.frame_text import set_subtitle, set_title
from catseye.app.tui.widgets.inks import Line, painted

if TYPE_CHECKING:
    # numpy and pydantic are not loaded before the first screen is painted.
    from catseye.app.protocol.run_events import LiveData
    from catseye.app.tui.widgets.braille import Canvas, Floats

INNOVATION: Final = "innovation"
"""Name of the live value: measured minus predicted from all points before."""

_STYLES: Final = {
    "in": "$success",
    "out": "bold $error",
    "band": "$text-muted",
}
_AXIS: Final = 8
"""Cells for the numbers at the left."""


class RunPlot(Widget):
    """A plot that is drawn anew only when its data or its size changed."""

    DEFAULT_CSS = """
    RunPlot { height: 1fr; min-height: 4; }
    """

    def __init__(self, title: str, *, id: str, classes: str) -> None:
        super().__init__(id=id, classes=f"panel {classes}")
        self._title = title
        set_title(self, title)
        self._of: tuple[object, ...] = ()
        self._shown = Content("")

    def show(self, run: RunState | None) -> None:
        """Show what is known of a run."""
        key = (None if run is None else run.name, self.key_of(run), self.size)
        if key != self._of:
            self._of = key
            # Nothing of the run before stays.
            set_title(self, self._title)
            set_subtitle(self, "")
            self._shown = self.drawn(run)
            self.refresh()

    def key_of(self, run: RunState | None) -> object:
        """Return what the drawing follows from, or a number that changes with it."""
        raise NotImplementedError

    def drawn(self, run: RunState | None) -> Content:
        """Return the drawing."""
        raise NotImplementedError

    def render(self) -> RenderResult:
        """Return the plot."""
        return self._shown


class LivePlot(RunPlot):
    """Innovations, newest at the right, what lies outside its band marked; before the first, another live value."""

    def __init__(self) -> None:
        super().__init__("Live values", id="live-plot", classes="")

    def key_of(self, run: RunState | None) -> object:
        """Return the newest value."""
        live = _watched(run)
        return None if live is None else (live.data, live.at_s)

    def drawn(self, run: RunState | None) -> Content:
        """Return the values that have room."""
        live = _watched(run)
        if live is None:
            return Content.styled("nothing yet", "dim")
        unit = f" / {live.data.unit}" if live.data.unit else ""
        outlying = f"Innovation{unit}, outlying beyond ±3u"
        set_title(self, outlying if live.data.name == INNOVATION else f"{live.data.name}{unit}")
        width = max(self.size.width - _AXIS, 1)
        outliers = sum(not each.accepted for each in live.history)
        if outliers:
            set_subtitle(self, f"× {outliers} of {len(live.history)} outside")
        return painted(_values(list(live.history)[-width:], width, max(self.size.height, 1)), _STYLES)


def _watched(run: RunState | None) -> LiveValue | None:
    if run is None:
        return None
    return run.live.get(INNOVATION) or run.watched


def _values(seen: Sequence["LiveData"], width: int, rows: int) -> list[Line]:
    """Draw one cell a value: dots within their bands, a cross for what is outside."""
    import numpy as np

    from catseye.app.tui.widgets.braille import DOTS_ACROSS, DOTS_DOWN, Canvas

    canvas = Canvas(width, rows)
    low, high = _scale(seen)

    def down(values: Sequence[float | None]) -> "Floats":
        """Return the place of values from the upper edge, in dots; NaN beyond the axis."""
        found = np.array(values, dtype=np.float64)
        return np.where(
            (found >= low) & (found <= high), (high - found) / (high - low) * (canvas.height - 1), np.nan
        )

    x = DOTS_ACROSS * np.arange(width - len(seen), width, dtype=np.float64)
    for limits in ([each.low for each in seen], [each.high for each in seen]):
        canvas.points(x, down(limits), "band")
    inside = down([each.value if each.accepted else None for each in seen])
    canvas.points(x, inside, "in")
    canvas.points(x + 1.0, inside, "in")
    for column, each in enumerate(seen, width - len(seen)):
        if not each.accepted:
            y = (high - each.value) / (high - low) * (canvas.height - 1)
            canvas.text(column, min(max(round(y / DOTS_DOWN), 0), rows - 1), "×", "out")
    return _with_numbers(canvas, {0: f"{high:.3g}", rows - 1: f"{low:.3g}"})


def _scale(seen: Sequence["LiveData"]) -> tuple[float, float]:
    """Return the ends of the upright axis; one wild value does not flatten the others, a far limit is left out."""
    widths = [each.high - each.low for each in seen if each.low is not None and each.high is not None]
    values = [each.value for each in seen if each.accepted or not widths] or [seen[-1].value]
    low, high = min(values), max(values)
    near = 10.0 * max(high - low, 1e-12)
    for each in seen:
        limits = [limit for limit in (each.low, each.high) if limit is not None]
        low, high = (
            min([low, *(x for x in limits if x >= low - near)]),
            max([high, *(x for x in limits if x <= high + near)]),
        )
    wild = [each.value for each in seen if not each.accepted]
    if widths and wild:
        room = max(widths)
        low, high = min(low, max(min(wild), low - room)), max(high, min(max(wild), high + room))
    return (low, high) if high > low else (low - 0.5, high + 0.5)


def _with_numbers(canvas: "Canvas", labels: dict[int, str]) -> list[Line]:
    return [
        [(labels.get(row, "").rjust(_AXIS - 2) + (" ┤" if row in labels else " │"), "band"), *pieces]
        for row, pieces in enumerate(canvas.lines())
    ]
