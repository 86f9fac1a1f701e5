"""A table of which rows are chosen, never cells; it is filtered, sorted by a column, and a row can be copied."""

from collections.abc import Callable, Iterable, Sequence
from typing import ClassVar, TypeVar

from rich.text import Text
from textual.binding import Binding, BindingType
from textual.widgets import DataTable

from catseye.app.tui.widgets.copying import copy
from catseye.app.tui.widgets.filtered_rows import FilteredRows
from catseye.app.tui.widgets.row_order import RowOrder

Item = TypeVar("Item")


class RowTable(DataTable[Text], FilteredRows):
    """Home and End go to the first and the last row; to the first and last column they would go unseen.

    Left and right choose a column. Whoever fills the table asks which rows it shows and in which order, and fills it
    anew when that has changed.
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("home", "scroll_top", "first", show=False),
        Binding("end", "scroll_bottom", "last", show=False),
        Binding(
            "s",
            "sort",
            "sort",
            show=False,
            id="table.sort",
            tooltip="sorts by the column chosen with left and right; again: the other way, then unsorted",
        ),
        Binding(
            "C",
            "copy_row",
            "copy row",
            show=False,
            id="table.copy",
            tooltip="copies the row to the clipboard, with tabs between the cells",
        ),
    ]

    def __init__(self, *, id: str) -> None:
        super().__init__(id=id, cursor_type="row", cell_padding=0, zebra_stripes=False)
        self._order = RowOrder()
        self._titles: dict[int, Text] = {}

    @property
    def chosen(self) -> str:
        """Key of the row under the cursor; empty where there is none."""
        if not self.is_valid_row_index(self.cursor_row):
            return ""
        return str(self.coordinate_to_cell_key(self.cursor_coordinate).row_key.value)

    def arranged(
        self,
        items: Iterable[Item],
        cells: Callable[[Item], Sequence[Text]],
        words: Callable[[Item], str] | None = None,
    ) -> list[Item]:
        """Return what the filter leaves, in the order that was asked for; as it comes where none was.

        Args:
            cells: of a row.
            words: that are searched, where they are others than those of the cells.
        """
        searched = words or (lambda item: " ".join(cell.plain for cell in cells(item)))
        left = (item for item in items if self.passes(searched(item)))
        columns = range(len(self.ordered_columns))
        return self._order.sorted(left, lambda item, column: cells(item)[column].plain, columns)

    def action_sort(self) -> None:
        """Sort by the column that is chosen: upwards, downwards, as it was."""
        self._order.turn()
        self._show_order()
        self.post_message(self.Rearranged())

    def action_cursor_left(self) -> None:
        """Choose the column before."""
        self._choose(self._order.column - 1)

    def action_cursor_right(self) -> None:
        """Choose the column behind."""
        self._choose(self._order.column + 1)

    def action_copy_row(self) -> None:
        """Copy the row under the cursor."""
        if self.is_valid_row_index(self.cursor_row):
            cells = [cell.plain.strip() for cell in self.get_row_at(self.cursor_row)]
            copy(self.app, "\t".join(cells))

    def _choose(self, column: int) -> None:
        self._order.column = max(0, min(column, len(self.ordered_columns) - 1))
        self._show_order()

    def _show_order(self) -> None:
        """Underline the column that is chosen, and put an arrow behind the one that sorts."""
        for place, column in enumerate(self.ordered_columns):
            title = self._titles.setdefault(place, column.label)
            chosen = "underline" if place == self._order.column else ""
            column.label = Text(f"{title.plain}{self._order.arrow(place)}", chosen)
        # The header is kept as it was drawn while no row changes.
        self._update_count += 1
        self.refresh()
