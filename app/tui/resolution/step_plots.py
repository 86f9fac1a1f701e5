"""Two plots of a series of steps under way: the staircase so far, and the errors of its steps."""

from typing import TYPE_CHECKING, Final

from textual.content import Content

from catseye.app.results.figures import Role
from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.frame_text import set_subtitle, set_title
from catseye.app.tui.widgets.inks import FIGURE_STYLES, painted
from catseye.app.tui.widgets.run_plots import RunPlot

if TYPE_CHECKING:
    # numpy and pydantic are not loaded before the first screen is painted.
    from collections.abc import Sequence

    from catseye.app.protocol.run_events import LiveStepData
    from catseye.app.results.figures import Dash, Mark, Panel
    from catseye.app.results.resolution.live_errors import LiveErrors
    from catseye.calibration.core.types import Floats

_NONE_YET: Final = "no step yet: the series begins with a standstill"
_SHOWN_PERCENT: Final = 60.0
_EQUAL: Final = 1e-3
"""Steps that differ by no more than this share are equal: they are drawn one after the other."""

_LEGEND: "Final[tuple[tuple[str, Dash, Role], ...]]" = (
    ("commanded", "dashed", Role.COMMAND),
    ("plateaus", "solid", Role.CHOSEN),
    ("below the instrument", "dotted", Role.MUTED),
)
_NEWEST: Final = 12
"""Steps of the staircase that are drawn: beside much larger ones the newest could not be seen."""


class StaircasePlot(RunPlot):
    """The newest plateaus as they look now, each with where its step was to lead from the plateau before."""

    def __init__(self) -> None:
        super().__init__("Staircase", id="staircase", classes="first")

    def key_of(self, run: RunState | None) -> object:
        """Return how many steps there are, and the last."""
        return _key_of(run)

    def drawn(self, run: RunState | None) -> Content:
        """Return the steps of the series under way."""
        seen = [] if run is None else run.staircase
        if not seen:
            return Content.styled(_NONE_YET, "dim")
        last = seen[-1]
        shown = seen[-_NEWEST:]
        set_title(self, f"Staircase {last.series}, steps {shown[0].number} to {last.number}")
        torque = "" if last.torque_nm is None else f"  {last.torque_nm:.1f} N m"
        set_subtitle(self, f"of {last.count}  {last.command:+.3g} {last.unit}{torque}")
        below = any(step.below for step in shown)
        return _painted(self, _stairs(shown), _LEGEND[: None if below else -1])


class StepErrorPlot(RunPlot):
    """Errors of the steps as they look now over their size, with their moving mean, its σ and the threshold."""

    def __init__(self) -> None:
        super().__init__("Step errors / %", id="step-errors", classes="second")

    def key_of(self, run: RunState | None) -> object:
        """Return how many steps there are, and the last."""
        return _key_of(run)

    def drawn(self, run: RunState | None) -> Content:
        """Return the errors of the series under way."""
        seen = [] if run is None else run.staircase
        if not seen:
            return Content.styled(_NONE_YET, "dim")
        from catseye.app.results.resolution.live_errors import live_errors

        known = live_errors(seen)
        mean = "" if known.mean_percent is None else ", mean ± σ"
        set_title(self, f"Step errors / %, band ±{seen[-1].band_percent:g}{mean}")
        set_subtitle(self, _said(seen, known))
        return _painted(self, _errors(seen, known))


def _key_of(run: RunState | None) -> object:
    return None if run is None or not run.staircase else (len(run.staircase), run.staircase[-1])


def _painted(plot: RunPlot, panel: "Panel", legend: "Sequence[tuple[str, Dash, Role]]" = ()) -> Content:
    """Return a panel, what its lines are behind its title."""
    from catseye.app.results.figures import Figure
    from catseye.app.tui.widgets.axis_scale import AxisKind
    from catseye.app.tui.widgets.chart import AXIS, Chart, Frame
    from catseye.app.tui.widgets.figure_scales import Scales
    from catseye.app.tui.widgets.inks import ink_name
    from catseye.app.tui.widgets.mark_drawing import draw, layer
    from catseye.app.tui.widgets.mark_signs import LINE_SAMPLES

    x, y = Scales(Figure("steps", "", "", ((panel,),))).of((0, 0))
    frame = Frame(panel.title, panel.x.plain, x=AxisKind(panel.x.decades, panel.counts[0]))
    chart = Chart(plot.size.width, plot.size.height, x, y, frame)
    if chart.usable:
        for mark in sorted(panel.marks, key=layer):
            draw(mark, chart)
    column = len(panel.title)
    for text, dash, role in legend:
        chart.canvas.text(column + 2, 0, LINE_SAMPLES[dash], ink_name(role))
        chart.canvas.text(column + 5, 0, text, AXIS)
        column += 5 + len(text)
    return painted(chart.canvas.lines(), FIGURE_STYLES)


def _stairs(seen: "Sequence[LiveStepData]") -> "Panel":
    import numpy as np

    from catseye.app.results.figures import Axis, Line, Panel

    number = np.array([step.number for step in seen], dtype=np.float64)
    reached = np.array([step.position for step in seen])
    # The controller adds each increment to where it measures the joint to stand.
    wanted = reached + np.array([step.command - step.measured for step in seen])
    # The third place of each plateau breaks the line: steps that never came here are not made up.
    across = np.column_stack([number - 0.5, number + 0.5, np.full(number.size, np.nan)]).ravel()
    below = np.repeat([step.below for step in seen], 3)
    level = np.repeat(reached, 3)
    marks = (
        Line(across, np.repeat(wanted, 3), Role.COMMAND, dash="dashed"),
        Line(across, np.where(below, np.nan, level), Role.CHOSEN),
        Line(across, np.where(below, level, np.nan), Role.MUTED, dash="dotted"),
    )
    return Panel(seen[0].unit, Axis("step"), Axis(), marks)


def _said(seen: "Sequence[LiveStepData]", known: "LiveErrors") -> str:
    """Return how far the mean keeps within the band, and what lies elsewhere, the most telling first."""
    judged = [step for step in seen if not step.below]
    outside = sum(abs(step.error_percent) > step.band_percent for step in judged)
    beyond = sum(abs(step.error_percent) > _SHOWN_PERCENT for step in seen)
    below = len(seen) - len(judged)
    said = [
        "" if known.least is None else f"mean within to {known.least:.2g} {seen[-1].unit}",
        f"× {outside} of {len(judged)} outside" if outside else "",
        f"{below} below the instrument" if below else "",
        f"{beyond} beyond ±{_SHOWN_PERCENT:g} %" if beyond else "",
    ]
    return ", ".join(text for text in said if text)


def _errors(seen: "Sequence[LiveStepData]", known: "LiveErrors") -> "Panel":
    import numpy as np

    from catseye.app.results.figures import Axis, Level, Panel

    band = seen[-1].band_percent
    size = np.abs(known.command)
    if np.ptp(size) < _EQUAL * size[0]:
        x, across = np.array([float(step.number) for step in seen]), Axis("step")
    else:
        x, across = np.log10(size), Axis(f"commanded step / {seen[0].unit}", decades=True)
    marks = (
        Level(0.0, Role.AXIS),
        Level(band, Role.CHANGE, dash="dashed"),
        Level(-band, Role.CHANGE, dash="dashed"),
        *_mean_marks(x, known),
        *_points(x, known),
    )
    return Panel("%", across, Axis(low=-_SHOWN_PERCENT, high=_SHOWN_PERCENT), marks)


def _points(x: "Floats", known: "LiveErrors") -> "list[Mark]":
    """Return the steps by their direction; those below the instrument have a sign of their own."""
    from catseye.app.results.figures import Points

    kinds = (
        (~known.below & (known.command > 0.0), Role.POSITIVE, ""),
        (~known.below & (known.command < 0.0), Role.NEGATIVE, ""),
        (known.below, Role.MUTED, "x"),
    )
    return [
        Points(x[kind], known.error_percent[kind], ink, marker=marker)
        for kind, ink, marker in kinds
        if kind.any()
    ]


def _mean_marks(x: "Floats", known: "LiveErrors") -> "list[Mark]":
    import numpy as np

    from catseye.app.results.figures import Band, Line

    mean, spread = known.mean_percent, known.spread_percent
    if mean is None or spread is None or not np.isfinite(mean).any():
        return []
    there = np.isfinite(mean)
    band = Band(x[there], (mean - spread)[there], (mean + spread)[there], Role.CHOSEN)
    return [band, Line(x[there], mean[there], Role.CHOSEN, width=1.6)]
