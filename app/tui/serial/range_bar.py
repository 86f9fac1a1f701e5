"""Where an axis stands within its range, in one line."""

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import AxisRange


def range_bar(axis: "AxisRange", value: float | None, cells: int) -> str:
    """Return a bar from the smallest to the largest value; `◀` and `▶` are beyond an end.

    Args:
        value: deg or mm; None while it is not known.
        cells: its width between the ends.
    """
    if value is None or not axis.low < axis.high:
        return f"├{'·' * cells}┤"
    if value < axis.low:
        return f"◀{'─' * cells}┤"
    if value > axis.high:
        return f"├{'─' * cells}▶"
    place = min(int((value - axis.low) / (axis.high - axis.low) * cells), cells - 1)
    return f"├{'─' * place}●{'─' * (cells - 1 - place)}┤"
