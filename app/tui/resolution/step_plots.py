"""Two plots of a series of steps under way: the staircase so far, and the errors of its steps."""

from typing import TYPE_CHECKING, Final

from textual.content import Content

from catseye.app.tui.run_state import RunState
from catseye.app.tui.widgets.inks import FIGURE_STYLES, painted
from catseye.app.tui.widgets.run_plots import RunPlot

if TYPE_CHECKING:
    # numpy and pydantic are not loaded before the first screen is painted.
    from collections.abc import Sequence

    from catseye.app.protocol.run_events import LiveStepData
    from catseye.app.results.figures import Panel

_NONE_YET: Final = "no step yet: the series begins with a standstill"
_SHOWN_PERCENT: Final = 60.0
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
        self.border_title = f"Staircase {last.series}, steps {shown[0].number} to {last.number}"
        torque = "" if last.torque_nm is None else f"  {last.torque_nm:.1f} N m"
        self.border_subtitle = f"of {last.count}  {last.command:+.3g} {last.unit}{torque}"
        return _painted(self, _stairs(shown))


class StepErrorPlot(RunPlot):
    """Errors of the steps as they look now over their size, with the band that is shown."""

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
        beyond = sum(abs(step.error_percent) > _SHOWN_PERCENT for step in seen)
        outside = sum(abs(step.error_percent) > step.band_percent for step in seen)
        self.border_title = f"Step errors / %, band ±{seen[-1].band_percent:g} %"
        more = f", {beyond} of them beyond ±{_SHOWN_PERCENT:g} %" if beyond else ""
        self.border_subtitle = f"× {outside} of {len(seen)} outside{more}" if outside else ""
        return _painted(self, _errors(seen))


def _key_of(run: RunState | None) -> object:
    return None if run is None or not run.staircase else (len(run.staircase), run.staircase[-1])


def _painted(plot: RunPlot, panel: "Panel") -> Content:
    from catseye.app.results.figures import Figure
    from catseye.app.tui.widgets.chart import Chart, Frame
    from catseye.app.tui.widgets.figure_scales import Scales
    from catseye.app.tui.widgets.mark_drawing import draw, layer

    x, y = Scales(Figure("steps", "", "", ((panel,),))).of((0, 0))
    frame = Frame(panel.title, panel.x.plain, x_decades=panel.x.decades)
    chart = Chart(plot.size.width, plot.size.height, x, y, frame)
    if chart.usable:
        for mark in sorted(panel.marks, key=layer):
            draw(mark, chart)
    return painted(chart.canvas.lines(), FIGURE_STYLES)


def _stairs(seen: "Sequence[LiveStepData]") -> "Panel":
    import numpy as np

    from catseye.app.results.figures import Axis, Line, Panel, Role

    number = np.array([step.number for step in seen], dtype=np.float64)
    reached = np.array([step.position for step in seen])
    # The controller adds each increment to where it measures the joint to stand.
    wanted = reached + np.array([step.command - step.measured for step in seen])
    # The third place of each plateau breaks the line: steps that never came here are not made up.
    across = np.column_stack([number - 0.5, number + 0.5, np.full(number.size, np.nan)]).ravel()
    marks = (
        Line(across, np.repeat(wanted, 3), Role.COMMAND, dash="dashed"),
        Line(across, np.repeat(reached, 3), Role.CHOSEN),
    )
    return Panel(f"{seen[0].unit}  ╌╌ commanded  ── plateaus", Axis("step"), Axis(), marks)


def _errors(seen: "Sequence[LiveStepData]") -> "Panel":
    import numpy as np

    from catseye.app.results.figures import Axis, Level, Panel, Points, Role

    size = np.log10([abs(step.command) for step in seen])
    error = np.array([step.error_percent for step in seen])
    band = seen[-1].band_percent
    marks = (
        Level(0.0, Role.AXIS),
        Level(band, Role.CHANGE, dash="dashed"),
        Level(-band, Role.CHANGE, dash="dashed"),
        Points(size, error, Role.POSITIVE if seen[-1].command > 0.0 else Role.NEGATIVE),
    )
    across = Axis(f"commanded step / {seen[0].unit}", decades=True)
    return Panel("%", across, Axis(low=-_SHOWN_PERCENT, high=_SHOWN_PERCENT), marks)
