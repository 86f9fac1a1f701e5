"""Figures as data: panels of marks in the units of their axes. A renderer chooses colours and fonts.

A mark names its role, never a colour; nothing is shown by colour alone, since markers and dashes go with roles too.
Sizes and widths are points of the printed page.
"""

from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING, Literal, TypeAlias

from catseye.procedures.kit.expanded import EXPANDED

if TYPE_CHECKING:
    # The first screen and the help are shown before numpy is imported.
    from catseye.calibration.core.types import Floats

Point: TypeAlias = tuple[float, float]
Dash: TypeAlias = Literal["solid", "dashed", "dotted", "dash-dotted"]


class Role(StrEnum):
    """What a mark stands for."""

    POSITIVE = "positive"  # approached upwards, or the way there
    NEGATIVE = "negative"  # approached downwards, or the way back
    CONVENTIONAL = "conventional"
    REVERSAL = "reversal"
    TRUTH = "truth"
    COMMAND = "command"
    SCATTER = "scatter"
    QUANTILE = "quantile"
    EXPECTED = "expected"
    AXIS = "axis"
    CHANGE = "change"
    CHOSEN = "chosen"
    BEAM = "beam"
    ARM = "arm"
    COLUMN = "column"
    MUTED = "muted"
    PATH = "path"
    ABOVE = "above"
    BELOW = "below"
    REGION = "region"


Ink: TypeAlias = Role | int
"""A role, or the place of a reflector in the list of reflectors."""


@dataclass(frozen=True)
class Line:
    """Points joined in order; NaN interrupts. `step` holds each value until the next; `marker` marks the points."""

    x: "Floats"
    y: "Floats"
    ink: Ink
    label: str = ""
    dash: Dash = "solid"
    width: float = 1.2
    step: bool = False
    faint: bool = False


@dataclass(frozen=True)
class Points:
    """Single points.

    Attributes:
        x: places.
        y: places.
        ink: role or reflector.
        label: in the legend; empty for none.
        u: standard uncertainties of y; error bars show them expanded.
        area: of each point, square points of print.
        value: colours the points by a scale of its own.
        value_label: of that scale.
        value_ends: of that scale; what lies above has the colour of the end.
        marker: in place of the ink's own, by its name in matplotlib.
        size: diameter.
        hollow: not filled.
        joined: joined by a line, in order.
        faint: half transparent.
        each: every one has its sign where letters draw them, however many there are.
    """

    x: "Floats"
    y: "Floats"
    ink: Ink
    label: str = ""
    u: "Floats | None" = None
    area: "Floats | None" = None
    value: "Floats | None" = None
    value_label: str = ""
    value_ends: tuple[float, float] | None = None
    marker: str = ""
    size: float = 4.5
    hollow: bool = False
    joined: bool = False
    faint: bool = False
    each: bool = False

    @property
    def half_bar(self) -> "Floats | None":
        """Half lengths of error bars: expanded uncertainties (k = 2)."""
        return None if self.u is None else EXPANDED * self.u


@dataclass(frozen=True)
class Band:
    """Region between two curves."""

    x: "Floats"
    low: "Floats"
    high: "Floats"
    ink: Ink
    label: str = ""

    @classmethod
    def around(cls, x: "Floats", y: "Floats", u: "Floats", ink: Ink, label: str = "") -> "Band":
        """Return the band of expanded uncertainties (k = 2) around a curve.

        Args:
            x: places.
            y: the curve.
            u: standard uncertainties of it.
            ink: role or reflector.
            label: in the legend; empty for none.
        """
        return cls(x, y - EXPANDED * u, y + EXPANDED * u, ink, label)


@dataclass(frozen=True)
class Bars:
    """Histogram: heights between edges."""

    edges: "Floats"
    height: "Floats"
    ink: Ink


@dataclass(frozen=True)
class Stems:
    """Spectrum: lines from zero."""

    x: "Floats"
    height: "Floats"
    ink: Ink


@dataclass(frozen=True)
class Level:
    """Straight line through the whole panel: at y, or at x; `label` in the legend, empty for none."""

    at: float
    ink: Ink
    vertical: bool = False
    dash: Dash = "solid"
    width: float = 0.8
    label: str = ""


@dataclass(frozen=True)
class Span:
    """Stretch of the x axis; `look` tells those apart that mean different things."""

    low: float
    high: float
    label: str
    look: int = 0


@dataclass(frozen=True)
class Shape:
    """Circle, wedge or ellipse: half axes; `from_deg`, `to_deg` of a wedge, `turn_deg` of an ellipse's first axis."""

    centre: Point
    half: Point
    ink: Ink
    label: str = ""
    filled: bool = False
    outlined: bool = True
    dashed: bool = False
    from_deg: float = 0.0
    to_deg: float = 360.0
    turn_deg: float = 0.0


@dataclass(frozen=True)
class Heat:
    """Values over a grid of places, shape (a, b)."""

    x: "Floats"
    y: "Floats"
    value: "Floats"
    label: str
    highest: float


@dataclass(frozen=True)
class Text:
    """Words at a place: beside it, centred above it, or in the upper left corner of the panel."""

    text: str
    at: Point | None = None
    ink: Ink = Role.TRUTH
    centred: bool = False


@dataclass(frozen=True)
class Arrow:
    """Head of an arrow on a panel of equal scales: which way something is driven.

    Attributes:
        at: its place.
        towards: the direction that it points in.
        ink: as of what is driven.
    """

    at: Point
    towards: Point
    ink: Ink


Mark: TypeAlias = Line | Points | Band | Bars | Stems | Level | Span | Shape | Heat | Text | Arrow


@dataclass(frozen=True)
class Axis:
    """Axis of a panel.

    Attributes:
        label: quantity and unit.
        symbol: TeX symbol before the label.
        low: lower end; None leaves it to the marks.
        high: upper end; None leaves it to the marks.
        shared: has the scale and the numbers of the panel to the left (y) or below (x).
        decades: marks and ends are common logarithms; the numbers at the axis are powers of ten.
        names: of the places 0, 1, 2 …, in place of numbers.
        counts: marks stand at whole numbers only.
    """

    label: str = ""
    symbol: str = ""
    low: float | None = None
    high: float | None = None
    shared: bool = False
    decades: bool = False
    names: tuple[str, ...] = ()
    counts: bool = False

    @property
    def plain(self) -> str:
        """Symbol and label without TeX."""
        symbol = self.symbol.replace("{", "").replace("}", "")
        return " / ".join(part for part in (symbol, self.label) if part)


@dataclass(frozen=True)
class Panel:
    """Marks on two axes; `equal` draws both to one scale."""

    title: str
    x: Axis
    y: Axis
    marks: tuple[Mark, ...]
    equal: bool = False

    @property
    def counts(self) -> tuple[bool, bool]:
        """Whether there are whole numbers only at the axis across, and upwards, where a histogram counts."""
        return self.x.counts, self.y.counts or any(isinstance(mark, Bars) for mark in self.marks)


@dataclass(frozen=True)
class Figure:
    """Rows of panels.

    Attributes:
        key: unique word; the page can be linked to it.
        label: what it is, for a reader who cannot see it.
        caption: text below.
        rows: panels by row, None for an empty place; each row fills the width.
        heights: share of each row.
        aspect: height over width of the whole.
        legend: where it stands.
        legend_columns: of its entries.
        note: one line under the panels.
    """

    key: str
    label: str
    caption: str
    rows: tuple[tuple[Panel | None, ...], ...]
    heights: tuple[float, ...] = ()
    aspect: float = 0.45
    legend: Literal["above", "below", "right", "inside"] = "above"
    legend_columns: int = 4
    note: str = ""


def columns(xy: "Floats") -> "tuple[Floats, Floats]":
    """Return x and y of places, shape (n, 2)."""
    return xy[:, 0], xy[:, 1]
