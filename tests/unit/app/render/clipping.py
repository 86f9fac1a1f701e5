"""Which words of a drawn figure leave its canvas, or lie on each other."""

from collections.abc import Iterator
from itertools import combinations

from matplotlib import rc_context
from matplotlib.axis import Axis
from matplotlib.figure import Figure as Drawn
from matplotlib.text import Text

from catseye.app.render.canvas import STYLE, lay_out
from catseye.app.render.mpl import drawn
from catseye.app.results.figures import Figure

_TOLERANCE_PX = 1.0


def clipped(figure: Figure) -> list[str]:
    """Return the texts of a figure that the edges of its canvas cut."""
    with rc_context(STYLE):
        whole = _laid_out(figure)
        right, top = whole.bbox.width + _TOLERANCE_PX, whole.bbox.height + _TOLERANCE_PX
        boxes = [(text.get_text(), text.get_window_extent()) for text in [*_numbers(whole), *_words(whole)]]
    return [
        text
        for text, box in boxes
        if text.strip() and (min(box.x0, box.y0) < -_TOLERANCE_PX or box.x1 > right or box.y1 > top)
    ]


def overlapping(figure: Figure) -> list[tuple[str, str]]:
    """Return pairs of entries of the legend, titles and labels of axes that lie on each other."""
    with rc_context(STYLE):
        whole = _laid_out(figure)
        boxes = [(text.get_text(), text.get_window_extent()) for text in _words(whole)]
    return [
        (one, other)
        for (one, first), (other, second) in combinations([box for box in boxes if box[0].strip()], 2)
        if first.padded(-_TOLERANCE_PX).overlaps(second.padded(-_TOLERANCE_PX))
    ]


def _laid_out(figure: Figure) -> Drawn:
    """Return a figure as it is laid out for a page."""
    whole = drawn(figure)
    lay_out(whole)
    whole.draw_without_rendering()
    return whole


def _words(whole: Drawn) -> Iterator[Text]:
    legends = [*whole.legends, *(one for axes in whole.axes if (one := axes.get_legend()) is not None)]
    for legend in legends:
        yield from legend.get_texts()
    for axes in whole.axes:
        titles = [text for text in axes.get_children() if isinstance(text, Text) and text not in axes.texts]
        yield from [*titles, axes.xaxis.label, axes.yaxis.label]
    yield from whole.texts


def _numbers(whole: Drawn) -> Iterator[Text]:
    for axes in whole.axes:
        for axis in (axes.xaxis, axes.yaxis):
            yield from _shown(axis)


def _shown(axis: Axis) -> Iterator[Text]:
    """Yield the numbers at an axis; those beyond its ends are not drawn."""
    low, high = sorted(axis.get_view_interval())
    for tick in axis.get_major_ticks():
        if low <= tick.get_loc() <= high and tick.label1.get_visible():
            yield tick.label1
