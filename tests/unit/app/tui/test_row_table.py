"""The tables of runs and results."""

from rich.text import Text
from textual.app import App, ComposeResult

from catseye.app.tui.widgets.row_table import RowTable


class TableApp(App[None]):
    def compose(self) -> ComposeResult:
        yield RowTable(id="table")

    def on_mount(self) -> None:
        table = self.query_one(RowTable)
        table.add_columns("run", "state")
        for number in range(50):
            table.add_row(Text(str(number)), Text("complete"))


async def test_home_and_end_select_the_first_and_last_row() -> None:
    app = TableApp()
    async with app.run_test(size=(80, 24)) as pilot:
        table = app.query_one(RowTable)
        table.focus()
        await pilot.press("end")
        assert table.cursor_row == 49
        await pilot.press("up", "home")
        assert table.cursor_row == 0
        await pilot.press("right", "left")
        assert table.cursor_row == 0


async def test_a_row_is_copied_with_tabs_between_its_cells() -> None:
    app = TableApp()
    async with app.run_test(size=(80, 24), notifications=True) as pilot:
        app.query_one(RowTable).focus()
        await pilot.press("down", "C")
        assert app.clipboard == "1\tcomplete"
        assert [(note.title, note.message) for note in app._notifications] == [("copied", "1 complete")]  # noqa: SLF001  # Textual shows them nowhere else
