"""Figures drawn with letters and braille dots: panels, one legend, note and caption."""

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from catseye.app.results.figures import Figure, Heat, Panel, Points
from catseye.app.tui.widgets.axis_scale import AxisKind
from catseye.app.tui.widgets.chart import AXIS, Chart, Frame, left_cells
from catseye.app.tui.widgets.figure_scales import Placed, Scales, panels_of
from catseye.app.tui.widgets.inks import Line, ink_name
from catseye.app.tui.widgets.mark_drawing import SHADES, draw, layer
from catseye.app.tui.widgets.mark_signs import SEVERAL, sample, value_ends

_NARROWEST: Final = 30
"""Panels that would be narrower stand below each other."""

_LOW_ROWS: Final = 3
_HIGH_ROWS: Final = 8
_SQUARE_ROWS: Final = 14
_ROOMY_ROWS: Final = 14
"""From this height on a panel has a line for the label of its axis across."""

_BETWEEN: Final[Line] = [("  ", "")]


@dataclass(frozen=True)
class _Strip:
    """Panels that stand side by side on the screen.

    Attributes:
        places: of the panels in the figure; None for an empty place.
        share: of the height.
        broken: the figure has more panels in this row.
    """

    places: tuple[Placed | None, ...]
    share: float
    broken: bool


def draw_figure(figure: Figure, width: int, height: int) -> list[Line]:
    """Return a figure that fills its place: what says what above, note and caption below.

    Args:
        width: in cells.
        height: in cells; rows of panels that have too little room are cut off at the end.
    """
    above, below = _legend(figure, width), _below(figure, width)
    strips = _strips(figure, width)
    frames: Sequence[Sequence[Frame | None]] = [_frames(figure, strip) for strip in strips]
    room = height - len(above) - len(below)
    heights = _heights(figure, strips, frames, room)
    scales = Scales(figure)
    frames = _fitted(strips, frames, heights, scales)
    drawn = [
        line
        for strip, own, rows in zip(strips, frames, heights, strict=True)
        for line in _draw_strip(figure, strip, own, scales, width, rows)
    ]
    if above and any(SEVERAL in text for line in drawn for text, _ in line):
        above[-1].append((f"{SEVERAL} several", AXIS))
    return [*above, *drawn, *below][:height]


def draw_beside(figures: Sequence[Figure], width: int, height: int) -> list[Line]:
    """Return figures beside each other, each as wide as the others."""
    own = _width_beside(len(figures), width)
    drawn = [draw_figure(figure, own, height) for figure in figures]
    filled = ([_filled(lines, row, own) for row in range(height)] for lines in drawn)
    return side_by_side(filled, _BETWEEN)


def side_by_side(drawn: Iterable[Sequence[Line]], between: Line) -> list[Line]:
    """Return drawings of one height beside each other."""
    return [
        [piece for number, line in enumerate(row) for piece in ([*between, *line] if number else line)]
        for row in zip(*drawn, strict=True)
    ]


def rows_needed_beside(figures: Sequence[Figure], width: int) -> int:
    """Return the height in cells from which on figures beside each other are readable."""
    own = _width_beside(len(figures), width)
    return max(rows_needed(figure, own) for figure in figures)


def rows_needed(figure: Figure, width: int) -> int:
    """Return the height in cells from which on a figure is readable."""
    strips = _strips(figure, width)
    other = len(_legend(figure, width)) + len(_below(figure, width))
    return other + sum(_least(figure, strip, _frames(figure, strip)) for strip in strips)


def _strips(figure: Figure, width: int) -> list[_Strip]:
    """Return what stands side by side: rows of the figure, broken where a panel would be too narrow."""
    most = max(width // _NARROWEST, 1)
    heights = figure.heights or (1.0,) * len(figure.rows)
    strips = []
    for row, (panels, share) in enumerate(zip(figure.rows, heights, strict=True)):
        places = [(row, place) if panel is not None else None for place, panel in enumerate(panels)]
        # As many in each part as in the others: four panels are two and two, not three and one.
        size = -(-len(places) // -(-len(places) // most))
        parts = [tuple(places[first : first + size]) for first in range(0, len(places), size)]
        strips += [_Strip(part, share, len(parts) > 1) for part in parts if any(part)]
    return strips


def _heading(panel: Panel) -> str:
    """Return title and quantity of a panel; a title that the quantity begins with is not said twice."""
    title, quantity = panel.title, panel.y.plain
    said = quantity == title or quantity.startswith(f"{title} ")
    return "  ".join(part for part in ("" if said else title, quantity) if part)


def _frames(figure: Figure, strip: _Strip) -> list[Frame | None]:
    """Return what stands around the panels; numbers that a neighbour has are left out."""
    frames: list[Frame | None] = []
    for number, place in enumerate(strip.places):
        panel = None if place is None else figure.rows[place[0]][place[1]]
        if panel is None:
            frames.append(None)
            continue
        frames.append(
            Frame(
                _heading(panel),
                panel.x.plain,
                x_numbers=strip.broken or not panel.x.shared,
                y_numbers=not number or not panel.y.shared,
                equal=panel.equal,
                x=AxisKind(panel.x.decades, panel.counts[0], panel.x.names),
                y=AxisKind(panel.y.decades, panel.counts[1], panel.y.names),
            )
        )
    return frames


def _other_rows(frames: Sequence[Frame | None]) -> int:
    return max(frame.other_rows for frame in frames if frame is not None)


def _least(figure: Figure, strip: _Strip, frames: Sequence[Frame | None]) -> int:
    if any(frame is not None and frame.equal for frame in frames):
        return _SQUARE_ROWS + _other_rows(frames)
    share = strip.share / max(figure.heights, default=1.0)
    return max(_LOW_ROWS, round(share * _HIGH_ROWS)) + _other_rows(frames)


def _heights(
    figure: Figure, strips: Sequence[_Strip], frames: Sequence[Sequence[Frame | None]], room: int
) -> list[int]:
    """Return the height of each strip: what it needs at least, and its share of what is left."""
    least = [_least(figure, strip, own) for strip, own in zip(strips, frames, strict=True)]
    left, whole = max(room - sum(least), 0), sum(strip.share for strip in strips)
    ends = np.rint(left * np.cumsum([strip.share for strip in strips]) / whole).astype(int).tolist()
    return [rows + end - before for rows, before, end in zip(least, [0, *ends[:-1]], ends, strict=True)]


def _fitted(
    strips: Sequence[_Strip],
    frames: Sequence[Sequence[Frame | None]],
    heights: Sequence[int],
    scales: Scales,
) -> list[list[Frame | None]]:
    """Return the frames with their lines for the labels, where there is room, and with their numbers' widths."""
    roomy = [
        [None if frame is None else replace(frame, label_row=_has_label_row(own, rows)) for frame in own]
        for own, rows in zip(frames, heights, strict=True)
    ]
    widths: dict[int, int] = {}
    for strip, own, rows in zip(strips, roomy, heights, strict=True):
        for place, frame in zip(strip.places, own, strict=True):
            if place is not None and frame is not None and frame.y_numbers:
                needed = left_cells(scales.of(place)[1], max(rows - frame.other_rows, 1), frame)
                widths[place[1]] = max(widths.get(place[1], 0), needed)
    # Panels above each other begin in one column.
    return [
        [
            replace(frame, left=widths[place[1]]) if place and frame and frame.y_numbers else frame
            for place, frame in zip(strip.places, own, strict=True)
        ]
        for strip, own in zip(strips, roomy, strict=True)
    ]


def _has_label_row(frames: Sequence[Frame | None], rows: int) -> bool:
    return rows >= _ROOMY_ROWS and any(frame is not None and frame.x_label for frame in frames)


def _draw_strip(
    figure: Figure, strip: _Strip, frames: Sequence[Frame | None], scales: Scales, width: int, rows: int
) -> list[Line]:
    """Return panels side by side, each as wide as the others."""
    count = len(strip.places)
    columns = _width_beside(count, width)
    drawn = [
        _blank(columns, rows)
        if place is None or frame is None
        else _draw_panel(figure, place, frame, scales, columns, rows)
        for place, frame in zip(strip.places, frames, strict=True)
    ]
    return side_by_side(drawn, _BETWEEN)


def _draw_panel(
    figure: Figure, place: Placed, frame: Frame, scales: Scales, columns: int, rows: int
) -> list[Line]:
    panel = figure.rows[place[0]][place[1]]
    x, y = scales.of(place)
    chart = Chart(columns, rows, x, y, frame)
    if panel is not None and chart.usable:
        for mark in sorted(panel.marks, key=layer):
            draw(mark, chart)
    return list(chart.canvas.lines())


def _width_beside(count: int, width: int) -> int:
    return (width - len(_BETWEEN[0][0]) * (count - 1)) // count


def _filled(lines: Sequence[Line], row: int, width: int) -> Line:
    """Return a line of a figure that is as wide as the figure."""
    line = list(lines[row]) if row < len(lines) else []
    missing = width - sum(len(text) for text, _ in line)
    return [*line, (" " * max(missing, 0), "")]


def _blank(columns: int, rows: int) -> list[Line]:
    return [[(" " * columns, "")] for _ in range(rows)]


def _legend(figure: Figure, width: int) -> list[Line]:
    """Return each label of the marks once, with what stands for it, in as many lines as it takes."""
    entries: dict[str, tuple[str, str]] = {}
    for _, panel in panels_of(figure):
        for mark in panel.marks:
            label, ink = getattr(mark, "label", ""), getattr(mark, "ink", AXIS)
            if isinstance(mark, Heat):
                entries[f"{label}, 0 to {mark.highest:.3g}"] = (SHADES, ink_name("heat"))
            elif isinstance(mark, Points) and mark.value is not None:
                low, high = value_ends(mark)
                entries[f"{mark.value_label}, {low:.3g} to {high:.3g}"] = ("0…9", ink_name(ink))
            elif label:
                entries.setdefault(label, (sample(mark), ink_name(ink)))
    lines: list[Line] = []
    used = width
    for label, (sign, ink) in entries.items():
        needed = len(sign) + len(label) + 4
        if used + needed > width + 3:
            lines.append([])
            used = 0
        lines[-1] += [(sign, ink), (f" {label}   ", AXIS)]
        used += needed
    return lines


def _below(figure: Figure, width: int) -> list[Line]:
    texts = [text for text in (figure.note, figure.caption) if text]
    return [[(line, AXIS)] for text in texts for line in textwrap.wrap(text, max(width, 20))]
