"""Two small plots of a run: innovation by point with its band, and the uncertainty of the maps as points come in."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Final

from textual.app import RenderResult
from textual.content import Content
from textual.widget import Widget

from app.tui.run_picture import RunPicture, Seen
from app.tui.widgets.inks import Line, painted

if TYPE_CHECKING:
    # numpy is not loaded before the first screen is painted.
    from app.tui.widgets.braille import Canvas

INNOVATION: Final = "innovation"
"""Name of the live value: measured minus predicted from all points before."""

_STYLES: Final = {
    "in": "$success",
    "out": "bold $error",
    "band": "$text-muted",
    "one": "$primary",
    "two": "$accent",
}
_AXIS: Final = 8
"""Cells for the numbers at the left."""


class RunPlot(Widget):
    """A plot that is drawn anew only when its data or its size changed."""

    DEFAULT_CSS = """
    RunPlot { height: 1fr; min-height: 4; }
    """

    def __init__(self, title: str, *, id: str) -> None:
        super().__init__(id=id, classes="panel")
        self.border_title = title
        self._of: tuple[object, ...] = ()
        self._shown = Content("")

    def show(self, run: RunPicture | None) -> None:
        """Show what is known of a run."""
        key = (None if run is None else run.name, self.key_of(run), self.size)
        if key != self._of:
            self._of = key
            self._shown = self.drawn(run)
            self.refresh()

    def key_of(self, run: RunPicture | None) -> object:
        """Return what the drawing follows from, or a number that changes with it."""
        raise NotImplementedError

    def drawn(self, run: RunPicture | None) -> Content:
        """Return the drawing."""
        raise NotImplementedError

    def render(self) -> RenderResult:
        """Return the plot."""
        return self._shown


class ResidualPlot(RunPlot):
    """Innovations, newest at the right; what lies outside ±3u is marked."""

    def __init__(self) -> None:
        super().__init__("Innovation / µm, band ±3u", id="residuals")

    def key_of(self, run: RunPicture | None) -> object:
        """Return the newest innovation."""
        live = None if run is None else run.live.get(INNOVATION)
        return None if live is None else live.history[-1]

    def drawn(self, run: RunPicture | None) -> Content:
        """Return the innovations that have room."""
        live = None if run is None else run.live.get(INNOVATION)
        if live is None:
            return Content.styled("none yet: it is told while distances are measured", "dim")
        width = max(self.size.width - _AXIS, 1)
        seen = list(live.history)[-width:]
        outliers = sum(not each.accepted for each in live.history)
        self.border_subtitle = f"× {outliers} of {len(live.history)} outside" if outliers else "none outside"
        return painted(_innovations(seen, width, max(self.size.height, 1)), _STYLES)


class MapPlot(RunPlot):
    """Largest standard uncertainty of both maps, on a logarithmic scale."""

    def __init__(self) -> None:
        super().__init__("Largest u of the maps / mdeg", id="maps")

    def key_of(self, run: RunPicture | None) -> object:
        """Return how often it was told, and the last."""
        return None if run is None or not run.map_known else (len(run.map_known), id(run.map_known[-1]))

    def drawn(self, run: RunPicture | None) -> Content:
        """Return both curves."""
        known = [] if run is None else list(run.map_known)
        if not known:
            return Content.styled("none yet: it is told after each row of J2", "dim")
        last = known[-1]
        self.border_subtitle = (
            f"{_told('Δθ1', last.get('u_theta1_mdeg'))} ●  {_told('Δθ2', last.get('u_theta2_mdeg'))} ○"
        )
        drawn = _uncertainties(known, max(self.size.width - _AXIS, 1), max(self.size.height, 1))
        return painted(drawn, _STYLES) if drawn else Content(str(last.get("text", "")))


def _innovations(seen: Sequence[Seen], width: int, rows: int) -> list[Line]:
    """Draw one cell a point: dots within their bands, a cross for what is outside."""
    from app.tui.widgets.braille import DOTS_DOWN, Canvas

    canvas = Canvas(width, rows)
    reach = max(*(max(abs(each.value), each.high or 0.0) for each in seen), 1e-9)
    # One wild point shall not flatten all others: the scale ends at three bands.
    widest = max((each.high or 0.0) for each in seen)
    reach = min(reach, 3.0 * widest) if widest > 0.0 else reach
    middle = (canvas.height - 1) / 2.0
    per_unit = middle / reach
    first = width - len(seen)
    for column, each in enumerate(seen, first):
        x = 2.0 * column
        for limit in (each.low, each.high):
            if limit is not None and abs(limit) <= reach:
                canvas.points(x, middle - limit * per_unit, "band")
        if each.accepted:
            canvas.points(x, middle - each.value * per_unit, "in")
            canvas.points(x + 1.0, middle - each.value * per_unit, "in")
        else:
            row = round((middle - each.value * per_unit) / DOTS_DOWN)
            canvas.text(column, min(max(row, 0), rows - 1), "×", "out")
    return _with_numbers(canvas, {0: f"{reach:+.3g}", rows // 2: "0", rows - 1: f"{-reach:+.3g}"})


def _uncertainties(known: Sequence[dict[str, Any]], width: int, rows: int) -> list[Line]:
    """Draw both curves against the rows of J2 that were measured."""
    import numpy as np

    from app.tui.widgets.braille import Canvas

    curves = [
        np.array([np.nan if each.get(key) is None else float(each[key]) for each in known])
        for key in ("u_theta1_mdeg", "u_theta2_mdeg")
    ]
    values = np.concatenate(curves)
    values = values[np.isfinite(values) & (values > 0.0)]
    if values.size == 0:
        return []
    low, high = float(np.log10(values.min())), float(np.log10(values.max()))
    if high - low < 0.3:
        low, high = low - 0.15, high + 0.15
    canvas = Canvas(width, rows)
    x = np.linspace(0.0, canvas.width - 1.0, len(known)) if len(known) > 1 else np.array([0.0])
    for curve, ink in zip(curves, ("one", "two"), strict=True):
        with np.errstate(invalid="ignore", divide="ignore"):
            y = (high - np.log10(curve)) / (high - low) * (canvas.height - 1)
        for number in range(1, len(known)):
            canvas.line((x[number - 1], y[number - 1]), (x[number], y[number]), ink)
        canvas.points(x, y, ink)
        ends = np.flatnonzero(np.isfinite(y))
        if ends.size:
            at = ends[-1]
            sign = "●" if ink == "one" else "○"
            canvas.text(min(int(x[at]) // 2, width - 1), min(int(y[at]) // 4, rows - 1), sign, ink)
    return _with_numbers(canvas, {0: f"{10.0**high:.3g}", rows - 1: f"{10.0**low:.3g}"})


def _with_numbers(canvas: "Canvas", labels: dict[int, str]) -> list[Line]:
    return [
        [(labels.get(row, "").rjust(_AXIS - 2) + (" ┤" if row in labels else " │"), "band"), *pieces]
        for row, pieces in enumerate(canvas.lines())
    ]


def _told(name: str, u_mdeg: float | None) -> str:
    return f"{name} –" if u_mdeg is None else f"{name} {u_mdeg:.1f}"
