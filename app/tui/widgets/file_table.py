"""The result files of a folder in rows, marked which one is shown and which one it is compared with."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from rich.text import Text

from catseye.app.tui import result_shelf as shelf
from catseye.app.tui.widgets.row_table import RowTable

if TYPE_CHECKING:
    # The first screen is painted before files and mathematics are imported.
    from catseye.app.tui.result_shelf import AnyFile


class FileTable(RowTable):
    """Rows by path; the cursor stays on its file."""

    def show_files(self, files: "Sequence[AnyFile]", shown: Path | None, compared: Path | None) -> None:
        """Show files.

        Args:
            shown: path of the one that is shown.
            compared: path of the one that it is compared with.
        """
        chosen = self.chosen
        files = self.arranged(files, lambda file: [Text(""), *map(Text, shelf.file_row(file))])
        row = min(self.cursor_row, len(files) - 1)
        self.clear()
        for place, file in enumerate(files):
            row = place if str(file.path) == chosen else row
            mark = "c" if file.path == compared else "▶" if file.path == shown else " "
            style = "bold red" if file.result is None else ""
            self.add_row(*(Text(cell, style) for cell in (mark, *shelf.file_row(file))), key=str(file.path))
        if files:
            self.move_cursor(row=max(row, 0))
