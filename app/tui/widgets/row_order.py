"""In which order rows stand: by one of their columns, upwards or downwards, or as they come."""

from collections.abc import Callable, Iterable
from typing import Final, TypeVar

Item = TypeVar("Item")

_ARROWS: Final = {False: "▲", True: "▼"}
"""Behind the title of the column by which rows are sorted: upwards, downwards."""


class RowOrder:
    """The column that is chosen, and the order that was asked for.

    Attributes:
        column: place of the one that is chosen.
    """

    def __init__(self) -> None:
        self.column = 0
        self._sorted: tuple[int, bool] | None = None

    def turn(self) -> None:
        """Sort by the column that is chosen: upwards, downwards, as it was."""
        orders = (None, (self.column, False), (self.column, True))
        place = orders.index(self._sorted) if self._sorted in orders else 0
        self._sorted = orders[(place + 1) % len(orders)]

    def arrow(self, place: int) -> str:
        """Return what stands behind the title of a column."""
        return _ARROWS[self._sorted[1]] if self._sorted and self._sorted[0] == place else ""

    def sorted(self, items: Iterable[Item], cell: Callable[[Item, int], str], columns: range) -> list[Item]:
        """Return items in the order that was asked for; as they come where none was, or by a column of others.

        Args:
            cell: text of a column of an item.
            columns: places of the columns that the items have.
        """
        if self._sorted is None or self._sorted[0] not in columns:
            return list(items)
        column, down = self._sorted
        return sorted(items, key=lambda item: _sort_key(cell(item, column)), reverse=down)


def _sort_key(text: str) -> tuple[int, float, str]:
    """Return where a cell belongs: numbers and times by their value and before words; empty cells last."""
    plain = text.strip().replace("−", "-")
    if not plain:
        return (2, 0.0, "")
    try:
        value = 0.0
        for part in plain.split(":"):
            value = 60.0 * value + float(part)
    except ValueError:
        return (1, 0.0, plain.lower())
    return (0, value, "")
