"""Tables of a report as text: their rows are filtered and sorted as those of any other table."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, ClassVar, Final

from textual.binding import Binding, BindingType

from catseye.app.tui.widgets.filtered_rows import FilteredRows
from catseye.app.tui.widgets.row_order import RowOrder

if TYPE_CHECKING:
    # The first screen is painted before files are imported.
    from catseye.app.results.model import Block, Cell, Table

_CHOSEN: Final = "›"
"""Before the title of the column that is chosen."""


class ArrangedTables(FilteredRows):
    """Left and right choose a column, through all tables that are shown; `s` sorts by it, `/` filters every table.

    Whoever shows the tables shows what `arranged` makes of them, and does it anew at each `Rearranged`.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(
            "s",
            "sort",
            "sort",
            show=False,
            id="table.sort",
            tooltip="by the column that left and right choose; again: the other way, then as it was",
        ),
    ]

    _order: RowOrder | None = None
    _columns = 0

    def forget_order(self) -> None:
        """Show all rows as they come: other tables are shown from now on."""
        self._order = None
        self.typed = ""
        self._show_filter(typing=False)

    def arranged(self, blocks: "Sequence[Block]") -> "list[Block]":
        """Return blocks with the rows of their tables that the filter leaves, in the order that was asked for."""
        from catseye.app.results.model import Table

        shown: list[Block] = []
        self._columns = 0
        for block in blocks:
            if isinstance(block, Table):
                shown.append(self._arranged(block, range(self._columns, self._columns + len(block.columns))))
                self._columns += len(block.columns)
            else:
                shown.append(block)
        return shown

    def choose_column(self, step: int) -> bool:
        """Choose the column before or behind; return whether there is a table."""
        if not self._columns:
            return False
        if self._order is None:
            self._order = RowOrder()
        else:
            self._order.column = max(0, min(self._order.column + step, self._columns - 1))
        self.post_message(self.Rearranged())
        return True

    def action_sort(self) -> None:
        """Sort by the column that is chosen: upwards, downwards, as it was."""
        if self._columns:
            self._order = self._order or RowOrder()
            self._order.turn()
            self.post_message(self.Rearranged())

    def _arranged(self, table: "Table", places: range) -> "Table":
        rows = [row for row in table.rows if self.passes(" ".join(_texts(table, row)))]
        order = self._order
        if order is None:
            return replace(table, rows=tuple(rows))
        rows = order.sorted(rows, lambda row, place: _texts(table, row)[place - places.start], places)
        columns = tuple(
            replace(
                column,
                title=f"{_CHOSEN if place == order.column else ''}{column.title}{order.arrow(place)}",
            )
            for place, column in zip(places, table.columns, strict=True)
        )
        return replace(table, columns=columns, rows=tuple(rows))


def place_of_choice(text: str) -> int | None:
    """Return where the column that is chosen begins in a text of tables; None where none is."""
    return next((place for line in text.splitlines() if (place := line.find(_CHOSEN)) >= 0), None)


def _texts(table: "Table", row: "Sequence[Cell]") -> list[str]:
    return list(_cell_texts(table, row))


def _cell_texts(table: "Table", row: "Sequence[Cell]") -> Iterator[str]:
    from catseye.app.render.cells import cell_text

    return (cell_text(cell, column, minus="-") for cell, column in zip(row, table.columns, strict=True))
