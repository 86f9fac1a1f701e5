"""Keys that choose an axis of any arm and move it by hand, and what stands beside the axes."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from textual.content import Content

from catseye.app.tui.jog_client import Way
from catseye.app.tui.serial.range_bar import range_bar

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import AxisRange

CHOOSE: Final[tuple[tuple[str, Way, str, str], ...]] = (
    ("up,w", -1, "axis-before", "previous axis"),
    ("down,s", 1, "axis-after", "next axis"),
)
"""Keys, which way they go through the axes, their name, and that in words."""

MOVE: Final[tuple[tuple[str, Way, str, str], ...]] = (
    ("left,a", -1, "axis-minus", "moves the chosen axis towards smaller values"),
    ("right,d", 1, "axis-plus", "moves the chosen axis towards larger values"),
)
"""Keys, which way they move the chosen axis, their name, and that in words."""

_BAR_CELLS: Final = 12


def axis_lines(
    axes: "Sequence[AxisRange]", joints: Sequence[float | None] | None, chosen: int, style: str
) -> list[Content]:
    """Return one line for each axis: which is chosen, its value, its place in its range.

    Args:
        joints: deg or mm; None while nothing is known of them.
        chosen: number of the axis that keys move, from 0.
        style: of the values.
    """
    if not axes:
        return [Content.styled("the axes of this arm are not known yet", "dim")]
    values = (None,) * len(axes) if joints is None else joints
    return [
        _line(axis, value, style, chosen=number == chosen)
        for number, (axis, value) in enumerate(zip(axes, values, strict=True))
    ]


def _line(axis: "AxisRange", value: float | None, style: str, *, chosen: bool) -> Content:
    number = "—" if value is None else f"{value:.3f}"
    return Content.assemble(
        ("▸ " if chosen else "  ", "bold"),
        (f"{axis.name:<5}", "reverse" if chosen else ""),
        (f"{number:>10} {axis.unit}  ", style),
        (range_bar(axis, value, _BAR_CELLS), style),
    )
