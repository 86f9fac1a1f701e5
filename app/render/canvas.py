"""What all figures share: style, colours, and the way to SVG.

The object interface of matplotlib is used throughout: no pyplot, no state, no window.
"""

import io
import re
import warnings
import zlib
from typing import Any

from matplotlib import rc_context
from matplotlib.figure import Figure

from catseye.app.render.compact_svg import compact
from catseye.app.render.markup import escaped, shown

STYLE: dict[Any, Any] = {
    "axes.axisbelow": True,
    "axes.edgecolor": "#5f6670",
    "axes.grid": True,
    "axes.labelsize": 9,
    "axes.linewidth": 0.8,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 9.5,
    "axes.titleweight": "bold",
    "figure.constrained_layout.use": True,
    "figure.facecolor": "none",
    "font.family": "DejaVu Sans",
    "font.size": 9,
    "grid.color": "#e3e6ea",
    "grid.linewidth": 0.7,
    "legend.fontsize": 8.5,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "mathtext.fontset": "dejavusans",
    "xtick.labelsize": 8.5,
    "ytick.labelsize": 8.5,
    "svg.fonttype": "none",
    "text.parse_math": False,
}
"""Settings of every figure. The keys are untyped: releases of matplotlib type them differently."""

WIDTH_IN = 8.0
"""Width of every figure; the printed page is about as wide."""


def lay_out(figure: Figure) -> None:
    """Give panels of one scale their places, which takes a pass more than others need.

    The pass that draws them leaves room for panels as wide as their places, and shrinks them only then.
    """
    if any(axes.get_aspect() != "auto" for axes in figure.axes):
        figure.draw_without_rendering()


_NOT_FOR_A_PAGE = re.compile(r"<\?xml.*?\?>|<!DOCTYPE.*?>", re.DOTALL)
_SIZE = re.compile(r'(<svg[^>]*?) width="[^"]*"', re.DOTALL)
_HEIGHT = re.compile(r'(<svg[^>]*?) height="[^"]*"', re.DOTALL)
_NAMES = re.compile(r'(\bid="|href="#|url\(#)')


_NO_WORD = re.compile(r"[^A-Za-z0-9_-]")


def _word(name: str) -> str:
    """Return a word that may stand in attributes and patterns; another one for every other name."""
    word = _NO_WORD.sub("-", name)
    return word if word == name else f"{word}-{zlib.crc32(name.encode(errors='backslashreplace')):x}"


def svg(figure: Figure, name: str, label: str) -> str:
    """Return a figure as an SVG element that may stand beside others in one page.

    Args:
        name: word that keeps the names inside this figure apart from those of other figures.
        label: what is read to somebody who cannot see it.
    """
    buffer = io.StringIO()
    nothing = {"Creator": None, "Date": None, "Format": None, "Type": None}
    with rc_context({**STYLE, "svg.hashsalt": name}), warnings.catch_warnings():
        # Text stays text: the browser draws what matplotlib's own font lacks, say a reflector named 反射.
        warnings.filterwarnings("ignore", message=r"Glyph \d+")
        lay_out(figure)
        figure.savefig(buffer, format="svg", metadata=nothing)
    # matplotlib writes control characters as they are, which XML does not know.
    text = _NOT_FOR_A_PAGE.sub("", shown(buffer.getvalue())).strip()
    text = _HEIGHT.sub(r"\1", _SIZE.sub(r"\1", text, count=1), count=1)
    text = _NAMES.sub(rf"\g<1>{_word(name)}-", compact(text))
    return text.replace("<svg ", f'<svg role="img" aria-label="{escaped(label)}" ', 1)
