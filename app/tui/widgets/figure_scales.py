"""Ends of the axes of a figure: those that are given, or what its marks need."""

from collections.abc import Callable, Iterator, Sequence
from functools import singledispatch
from typing import Final, TypeAlias

import numpy as np

from catseye.app.results.figures import (
    Axis,
    Band,
    Bars,
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
from catseye.app.tui.widgets.axis_scale import Ends
from catseye.app.tui.widgets.braille import Floats
from catseye.app.tui.widgets.shape_outline import outline

_MARGIN: Final = 0.02

Placed: TypeAlias = tuple[int, int]
"""Row and place of a panel in its figure."""


_Values = tuple[Sequence[float] | Floats, Sequence[float] | Floats]


class Scales:
    """Ends of the axes of each panel; those that share a scale hold the marks of all."""

    def __init__(self, figure: Figure) -> None:
        self._figure = figure
        self._x = self._shared("x", lambda row, place: (row + 1, place))
        self._y = self._shared("y", lambda row, place: (row, place - 1))

    def of(self, place: Placed) -> tuple[Ends, Ends]:
        """Return the ends across and upwards."""
        return self._x[place], self._y[place]

    def _shared(self, name: str, neighbour: Callable[[int, int], Placed]) -> dict[Placed, Ends]:
        panels = dict(panels_of(self._figure))
        groups: dict[Placed, list[Placed]] = {}
        for place in panels:
            first = place
            while _axis(panels[first], name).shared and neighbour(*first) in panels:
                first = neighbour(*first)
            groups.setdefault(first, []).append(place)
        return {
            place: _ends([panels[each] for each in members], name)
            for members in groups.values()
            for place in members
        }


def _axis(panel: Panel, name: str) -> Axis:
    return panel.x if name == "x" else panel.y


def _ends(panels: Sequence[Panel], name: str) -> Ends:
    """Return the ends of an axis: those that are given, else of all marks with a margin."""
    every = [_ends_of(mark)[name == "y"] for panel in panels for mark in panel.marks]
    values = np.concatenate([np.zeros(0), *(np.asarray(part, dtype=np.float64).ravel() for part in every)])
    values = values[np.isfinite(values)]
    low, high = (float(values.min()), float(values.max())) if values.size else (0.0, 1.0)
    margin = _MARGIN * (high - low)
    lows = [axis.low for panel in panels if (axis := _axis(panel, name)).low is not None]
    highs = [axis.high for panel in panels if (axis := _axis(panel, name)).high is not None]
    return (
        low - margin if not lows or lows[0] is None else lows[0],
        high + margin if not highs or highs[0] is None else highs[0],
    )


def panels_of(figure: Figure) -> Iterator[tuple[Placed, Panel]]:
    """Yield the panels that there are, with their places."""
    for row, panels in enumerate(figure.rows):
        for place, panel in enumerate(panels):
            if panel is not None:
                yield (row, place), panel


@singledispatch
def _ends_of(mark: Mark) -> _Values:
    """Return x and y of places that the axes have to hold."""
    raise TypeError(type(mark).__name__)


@_ends_of.register
def _(mark: Line) -> _Values:
    return mark.x, mark.y


@_ends_of.register
def _(mark: Points) -> _Values:
    half = 0.0 if mark.half_bar is None else mark.half_bar
    return mark.x, np.concatenate([mark.y - half, mark.y + half])


@_ends_of.register
def _(mark: Band) -> _Values:
    return mark.x, np.concatenate([mark.low, mark.high])


@_ends_of.register
def _(mark: Bars) -> _Values:
    return mark.edges, [0.0, *mark.height]


@_ends_of.register
def _(mark: Stems) -> _Values:
    return mark.x, [0.0, *mark.height]


@_ends_of.register
def _(mark: Level) -> _Values:
    return ([mark.at], []) if mark.vertical else ([], [mark.at])


@_ends_of.register
def _(mark: Span) -> _Values:
    return [mark.low, mark.high], []


@_ends_of.register
def _(mark: Shape) -> _Values:
    return outline(mark)


@_ends_of.register
def _(mark: Heat) -> _Values:
    return np.ravel(mark.x), np.ravel(mark.y)


@_ends_of.register
def _(mark: Text) -> _Values:
    return ([], []) if mark.at is None else ([mark.at[0]], [mark.at[1]])
