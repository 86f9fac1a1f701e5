"""Figures drawn by matplotlib; no figure of its own stands here."""

import math
from dataclasses import dataclass
from functools import singledispatch
from typing import Any, Final, Literal

from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.axis import Axis as DrawnAxis
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure as Drawn
from matplotlib.patches import Circle, Ellipse, Patch, Wedge
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, MultipleLocator

from catseye.app.render.canvas import STYLE, WIDTH_IN
from catseye.app.render.palette import NOTE, SPAN_HATCH, SPANS, look_of
from catseye.app.results.figures import (
    Arrow,
    Axis,
    Band,
    Bars,
    Dash,
    Figure,
    Heat,
    Level,
    Line,
    Mark,
    Panel,
    Points,
    Shape,
    Span,
    Stems,
    Text,
)

_DASHES: Final[dict[Dash, str]] = {"solid": "-", "dashed": "--", "dotted": ":", "dash-dotted": "-."}
_FAINT: Final = 0.55
_NARROW: Final = 3
"""A row of more panels has smaller titles."""

_Grid = list[list[Axes | None]]


@dataclass(frozen=True)
class _Scale:
    """Marks coloured by value; `extend` says whether values lie beyond the end of the scale."""

    marks: ScalarMappable
    label: str
    extend: Literal["neither", "max"] = "neither"


@rc_context(STYLE)
def drawn(figure: Figure) -> Drawn:
    """Return a figure drawn."""
    whole = Drawn(figsize=(WIDTH_IN, WIDTH_IN * figure.aspect))
    grid = _grid(whole, figure)
    rows = [
        [(axes, panel) for axes, panel in zip(*row, strict=True) if axes is not None and panel is not None]
        for row in zip(grid, figure.rows, strict=True)
    ]
    scales = [[scale for pair in row for scale in _draw_marks(*pair)] for row in rows]
    # Ends that are given stop a scale from growing: not before everything that shares it is drawn.
    for row, coloured in zip(rows, scales, strict=True):
        for axes, panel in row:
            _write_axes(axes, panel, len(row))
        _colour_bar(whole, [axes for axes, _ in row], coloured)
    whole.align_ylabels([row[0] for row in grid if row[0] is not None])
    _legend(whole, grid, figure)
    if figure.note:
        whole.supxlabel(figure.note, fontsize=8, color=NOTE)
    return whole


def _grid(whole: Drawn, figure: Figure) -> _Grid:
    """Return axes row by row; rows of different length share the width."""
    width = math.lcm(*map(len, figure.rows))
    spec = whole.add_gridspec(len(figure.rows), width, height_ratios=figure.heights or None)
    grid: _Grid = []
    for i, panels in enumerate(figure.rows):
        step = width // len(panels)
        grid.append(
            [
                None if panel is None else whole.add_subplot(spec[i, j * step : (j + 1) * step])
                for j, panel in enumerate(panels)
            ]
        )
    _share(grid, figure)
    return grid


def _share(grid: _Grid, figure: Figure) -> None:
    """Give panels the scales of their neighbours, which alone have numbers."""
    for i, panels in enumerate(figure.rows):
        for j, panel in enumerate(panels):
            axes = grid[i][j]
            if axes is None or panel is None:
                continue
            below = grid[i + 1][j] if panel.x.shared else None
            left = grid[i][j - 1] if panel.y.shared else None
            if below is not None:
                axes.sharex(below)
                axes.tick_params(labelbottom=False)
            if left is not None:
                axes.sharey(left)
                axes.tick_params(labelleft=False)


def _draw_marks(axes: Axes, panel: Panel) -> list[_Scale]:
    if panel.equal:
        axes.set_aspect("equal", adjustable="box")
    scales = [draw(mark, axes) for mark in panel.marks]
    return [scale for scale in scales if scale is not None]


def _write_axes(axes: Axes, panel: Panel, beside: int) -> None:
    axes.set_title(panel.title, fontsize=8.5 if beside > _NARROW else None)
    for label, limits, axis in (
        (axes.set_xlabel, axes.set_xlim, panel.x),
        (axes.set_ylabel, axes.set_ylim, panel.y),
    ):
        label(_axis_text(axis), parse_math=bool(axis.symbol))
        if axis.low is not None or axis.high is not None:
            limits(axis.low, axis.high)
    for drawn_axis, axis, counts in zip(
        (axes.xaxis, axes.yaxis), (panel.x, panel.y), panel.counts, strict=True
    ):
        if axis.decades:
            _number_decades(drawn_axis)
        if counts:
            drawn_axis.set_major_locator(MaxNLocator(integer=True))
        if axis.names:
            drawn_axis.set_ticks(range(len(axis.names)), axis.names)


def _number_decades(axis: DrawnAxis) -> None:
    """Write powers of ten at an axis of common logarithms, with small marks at their multiples."""
    low, high = axis.get_view_interval()
    whole = range(math.floor(low), math.ceil(high))
    axis.set_major_locator(MultipleLocator(1.0))
    axis.set_major_formatter(FuncFormatter(lambda value, _: f"{10.0**value:g}"))
    axis.set_minor_locator(
        FixedLocator([decade + math.log10(digit) for decade in whole for digit in range(2, 10)])
    )


def _axis_text(axis: Axis) -> str:
    return f"${axis.symbol}$ / {axis.label}" if axis.symbol else axis.label


def _colour_bar(whole: Drawn, row: list[Axes], scales: list[_Scale]) -> None:
    """Draw the colours of a row's marks, once."""
    if scales:
        last = scales[-1]
        whole.colorbar(last.marks, ax=row, shrink=0.8, extend=last.extend, label=last.label)


def _legend(whole: Drawn, grid: _Grid, figure: Figure) -> None:
    """Draw one legend for all panels, each label once."""
    every = [axes for row in grid for axes in row if axes is not None]
    named = {
        label: handle
        for axes in every
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
    }
    if not named:
        return
    handles, labels, columns = list(named.values()), list(named), figure.legend_columns
    if figure.legend == "right":
        every[-1].legend(handles, labels, loc="upper left", bbox_to_anchor=(1.01, 1.0))
    elif figure.legend == "inside":
        every[0].legend(handles, labels, loc="upper right", ncols=columns)
    else:
        upper = figure.legend == "above"
        whole.legend(
            handles,
            labels,
            loc="outside upper center" if upper else "outside lower center",
            ncols=columns,
        )


@singledispatch
def draw(mark: Mark, _axes: Axes) -> _Scale | None:
    """Draw a mark; return the scale of its colours, if it has one."""
    raise TypeError(type(mark).__name__)


@draw.register
def _(mark: Line, axes: Axes) -> None:
    axes.plot(
        mark.x,
        mark.y,
        color=look_of(mark.ink).colour,
        linestyle=_DASHES[mark.dash],
        linewidth=mark.width,
        drawstyle="steps-post" if mark.step else "default",
        solid_capstyle="round" if mark.faint else "butt",
        alpha=_FAINT if mark.faint else None,
        label=mark.label,
    )


@draw.register
def _(mark: Points, axes: Axes) -> _Scale | None:
    look = look_of(mark.ink)
    marker = mark.marker or look.marker
    if mark.value is not None:
        low, high = mark.value_ends or (None, None)
        size = mark.size**2
        shown = axes.scatter(
            mark.x, mark.y, size, c=mark.value, marker=marker, cmap="viridis", vmin=low, vmax=high
        )
        return _Scale(shown, mark.value_label, "max" if mark.value_ends else "neither")
    if mark.area is not None:
        axes.scatter(
            mark.x, mark.y, mark.area, c=look.colour, marker=marker, linewidths=0.0, label=mark.label
        )
        return None
    style: dict[str, Any] = {
        "color": look.colour,
        "marker": marker,
        "linestyle": look.dash if mark.joined else "none",
        "markersize": mark.size,
        "markerfacecolor": "none" if mark.hollow else look.face or look.colour,
        "alpha": _FAINT if mark.faint else None,
        "label": mark.label,
    }
    if mark.half_bar is None:
        axes.plot(mark.x, mark.y, markeredgewidth=0.8, **style)
    else:
        bars: dict[str, Any] = {"capsize": 3.0} if mark.joined else {"elinewidth": 0.7}
        axes.errorbar(mark.x, mark.y, mark.half_bar, **bars, **style)
    return None


@draw.register
def _(mark: Band, axes: Axes) -> None:
    colour = look_of(mark.ink).colour
    axes.fill_between(mark.x, mark.low, mark.high, color=colour, alpha=0.3, linewidth=0.0, label=mark.label)


@draw.register
def _(mark: Bars, axes: Axes) -> None:
    colour = look_of(mark.ink).colour
    width = mark.edges[1:] - mark.edges[:-1]
    axes.bar(
        mark.edges[:-1], mark.height, width, align="edge", color=colour, edgecolor="white", linewidth=0.4
    )


@draw.register
def _(mark: Stems, axes: Axes) -> None:
    axes.vlines(mark.x, 0.0, mark.height, color=look_of(mark.ink).colour, linewidth=1.0)


@draw.register
def _(mark: Level, axes: Axes) -> None:
    line = axes.axvline if mark.vertical else axes.axhline
    colour, dash = look_of(mark.ink).colour, _DASHES[mark.dash]
    line(mark.at, color=colour, linewidth=mark.width, linestyle=dash, label=mark.label)


@draw.register
def _(mark: Span, axes: Axes) -> None:
    colour, hatch = SPANS[mark.look % len(SPANS)]
    style: dict[str, Any] = {"facecolor": colour, "edgecolor": SPAN_HATCH, "hatch": hatch, "linewidth": 0.0}
    axes.axvspan(mark.low, mark.high, zorder=0.5, label=mark.label, **style)


@draw.register
def _(mark: Shape, axes: Axes) -> None:
    look = look_of(mark.ink)
    edge: dict[str, Any] = {"edgecolor": look.colour, "linewidth": 0.8}
    edge["linestyle"] = (0, (5, 4)) if mark.dashed else "-"
    if mark.filled and look.face:
        axes.add_patch(_patch(mark, facecolor=look.face, hatch="////", **edge))
    elif mark.filled:
        axes.add_patch(_patch(mark, facecolor=look.colour, alpha=0.14, linewidth=0.0))
    if mark.outlined and not (mark.filled and look.face):
        axes.add_patch(_patch(mark, fill=False, **edge))
    if mark.label:
        axes.patches[-1].set_label(mark.label)


def _patch(mark: Shape, **style: Any) -> Patch:
    if mark.to_deg - mark.from_deg < 360.0:
        return Wedge(mark.centre, mark.half[0], mark.from_deg, mark.to_deg, **style)
    if mark.half[0] == mark.half[1]:
        return Circle(mark.centre, mark.half[0], **style)
    return Ellipse(mark.centre, 2.0 * mark.half[0], 2.0 * mark.half[1], angle=mark.turn_deg, **style)


@draw.register
def _(mark: Heat, axes: Axes) -> _Scale:
    shown = axes.pcolormesh(
        mark.x,
        mark.y,
        mark.value,
        shading="gouraud",
        cmap="magma_r",
        vmin=0.0,
        vmax=mark.highest,
        rasterized=True,
    )
    return _Scale(shown, mark.label)


@draw.register
def _(mark: Text, axes: Axes) -> None:
    colour = look_of(mark.ink).colour
    if mark.at is None:
        axes.text(0.02, 0.97, mark.text, transform=axes.transAxes, va="top", fontsize=8, color=colour)
    elif mark.centred:
        axes.text(*mark.at, mark.text, ha="center", va="bottom", fontsize=7.5, color=colour)
    else:
        axes.annotate(
            mark.text, mark.at, xytext=(8, 4), textcoords="offset points", color=colour, fontweight="bold"
        )


@draw.register
def _(mark: Arrow, axes: Axes) -> None:
    turned_deg = math.degrees(math.atan2(mark.towards[1], mark.towards[0])) - 90.0
    head: Any = (3, 0, turned_deg)
    axes.plot(
        *mark.at,
        marker=head,
        color=look_of(mark.ink).colour,
        markersize=9.0,
        markeredgecolor="white",
        zorder=3.0,
    )
