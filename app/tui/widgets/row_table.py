"""A table of which rows are chosen, never cells; a row can be copied."""

from typing import ClassVar

from rich.text import Text
from textual.binding import Binding, BindingType
from textual.widgets import DataTable

from catseye.app.tui.widgets.copying import copy


class RowTable(DataTable[Text]):
    """Home and End go to the first and the last row; to the first and last column they would go unseen."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("home", "scroll_top", "first", show=False),
        Binding("end", "scroll_bottom", "last", show=False),
        Binding(
            "C",
            "copy_row",
            "copy row",
            show=False,
            id="table.copy",
            tooltip="to the clipboard, cells between tabs: a spreadsheet takes them apart",
        ),
    ]

    def __init__(self, *, id: str) -> None:
        super().__init__(id=id, cursor_type="row", cell_padding=0, zebra_stripes=False)

    def action_copy_row(self) -> None:
        """Copy the row under the cursor."""
        if self.is_valid_row_index(self.cursor_row):
            cells = [cell.plain.strip() for cell in self.get_row_at(self.cursor_row)]
            copy(self.app, "\t".join(cells))
