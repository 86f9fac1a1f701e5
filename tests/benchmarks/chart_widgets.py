"""The widgets of `chart_peers`: each kind imports only what it draws with."""

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

from textual.widget import Widget
from textual.widgets import Static

if TYPE_CHECKING:
    from catseye.app.tui.widgets.braille import Floats

Fed = Callable[[list[float]], None]
COLUMNS = 110
HALF_BAR = 1.6
"""Half length of an error bar, mdeg."""

NODES = tuple(10.0 * place for place in range(-14, 15))


def value_at(t_s: float) -> float:
    """Return a displacement in mm: a slow wave, a fast one, and a spike of one sample every 3 s."""
    spike = 0.004 if round(t_s * 1000.0) % 3000 == 1500 else 0.0
    return 743.12 + 0.002 * math.sin(t_s) + 0.0004 * math.sin(170.0 * t_s) + spike


def _curves() -> tuple[list[float], list[float]]:
    up = [20.0 * math.sin(node / 40.0) - 4.0 for node in NODES]
    return up, [value + 6.0 + 2.0 * math.cos(node / 25.0) for value, node in zip(up, NODES, strict=True)]


def nothing() -> tuple[Widget, Widget, Fed]:
    """Return no drawing: what the program costs without one."""
    return Static("trace"), Static("map"), lambda _: None


def ours() -> tuple[Widget, Widget, Fed]:
    """Return the strip chart and the error map of the program."""
    import numpy as np

    from catseye.app.results.figures import Axis, Figure, Level, Panel, Points, Role
    from catseye.app.tui.widgets import strip_chart
    from catseye.app.tui.widgets.figure_view import Figures
    from catseye.app.tui.widgets.inks import painted

    trace, scale = Static(), None

    def feed(values: list[float]) -> None:
        nonlocal scale
        if not trace.size.width:
            return
        low, high = _folded(values, strip_chart.dots_of(trace.size.width))
        scale = strip_chart.next_scale(scale, float(np.nanmin(low)), float(np.nanmax(high)))
        if scale is not None:
            lines = strip_chart.draw(low, high, scale, trace.size.width, trace.size.height)
            trace.update(painted(lines, {"trace": "$success", "axis": "dim"}))

    up, down = (np.array(values) for values in _curves())
    nodes, u = np.array(NODES), np.full(len(NODES), HALF_BAR)
    marks = (
        Level(0.0, Role.AXIS),
        Points(nodes, up, Role.POSITIVE, "positive", u, joined=True),
        Points(nodes, down, Role.NEGATIVE, "negative", u, joined=True),
    )
    figure = Figure("map", "", "", ((Panel("", Axis("command / °"), Axis("mdeg"), marks),),))
    error_map = Figures()
    error_map.call_after_refresh(lambda: error_map.show(figure))
    return trace, error_map, feed


def peer() -> tuple[Widget, Widget, Fed]:
    """Return the same drawn by textual-plot."""
    import numpy as np
    from textual_plot import HiResMode, LegendLocation, PlotWidget

    trace, chart = PlotWidget(), PlotWidget()

    def feed(values: list[float]) -> None:
        if not trace.size.width:
            return
        low, high = _folded(values, 2 * COLUMNS)
        shown = np.isfinite(low)
        both = np.column_stack([low[shown], high[shown]]).ravel()
        trace.clear()
        trace.plot(np.repeat(np.flatnonzero(shown) * 10.0 / low.size, 2), both, "green", HiResMode.BRAILLE)

    def draw_map() -> None:
        up, down = _curves()
        u = np.full(len(NODES), HALF_BAR)
        for values, colour, name in ((up, "red", "positive"), (down, "blue", "negative")):
            chart.plot(NODES, values, colour, HiResMode.BRAILLE)
            chart.errorbar(NODES, values, None, u, "", colour, hires_mode=HiResMode.BRAILLE, label=name)
        chart.set_xlabel("command / °")
        chart.set_ylabel("mdeg")
        chart.show_legend(LegendLocation.TOPLEFT)

    chart.call_after_refresh(draw_map)
    return trace, chart, feed


def _folded(values: list[float], dots: int) -> "tuple[Floats, Floats]":
    import numpy as np

    from catseye.app.tui.widgets.strip_chart import fold

    samples = np.array(values)
    return fold(samples, samples, samples.size, -(-10_000 // dots), dots)


KINDS = {"none": nothing, "ours": ours, "peer": peer}
