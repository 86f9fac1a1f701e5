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


class SortedApp(App[None]):
    ROWS = (("b", "10.5"), ("A", "−2"), ("c", ""), ("d", "9"))

    def compose(self) -> ComposeResult:
        yield RowTable(id="table")

    def on_mount(self) -> None:
        self.query_one(RowTable).add_columns("run", "mm")
        self.on_filtered_rows_rearranged()

    def on_filtered_rows_rearranged(self) -> None:
        table = self.query_one(RowTable)
        table.clear()
        for row in table.arranged(self.ROWS, lambda row: [Text(cell) for cell in row]):
            table.add_row(*map(Text, row), key=row[0])

    @property
    def order(self) -> str:
        table = self.query_one(RowTable)
        return "".join(table.get_row_at(place)[0].plain for place in range(table.row_count))

    @property
    def titles(self) -> list[str]:
        return [column.label.plain for column in self.query_one(RowTable).ordered_columns]


async def test_a_table_is_sorted_by_the_chosen_column_and_back() -> None:
    app = SortedApp()
    async with app.run_test(size=(40, 10)) as pilot:
        app.query_one(RowTable).focus()
        for key, order, titles in (
            ("s", "Abcd", ["run▲", "mm"]),
            ("s", "dcbA", ["run▼", "mm"]),
            ("s", "bAcd", ["run", "mm"]),
            ("right", "bAcd", ["run", "mm"]),
            ("s", "Adbc", ["run", "mm▲"]),
            ("s", "cbdA", ["run", "mm▼"]),
            ("left", "cbdA", ["run", "mm▼"]),
            ("s", "Abcd", ["run▲", "mm"]),
        ):
            await pilot.press(key)
            await pilot.pause()
            assert (app.order, app.titles) == (order, titles), key


async def test_the_chosen_row_is_known_by_its_key() -> None:
    app = SortedApp()
    async with app.run_test(size=(40, 10)) as pilot:
        app.query_one(RowTable).focus()
        await pilot.press("s", "down")
        await pilot.pause()
        assert app.query_one(RowTable).chosen == "b"


async def test_slash_filters_live_and_escape_shows_all() -> None:
    app = SortedApp()
    async with app.run_test(size=(40, 10)) as pilot:
        table = app.query_one(RowTable)
        table.focus()
        for key, order, edge in (
            ("slash", "bAcd", "/ ▏"),
            ("1", "b", "/ 1▏"),
            ("0", "b", "/ 10▏"),
            ("backspace", "b", "/ 1▏"),
            ("backspace", "bAcd", "/ ▏"),
            ("9", "d", "/ 9▏"),
            ("enter", "d", "/ 9  Esc: all"),
            ("escape", "bAcd", ""),
            ("escape", "bAcd", ""),
        ):
            await pilot.press(key)
            await pilot.pause()
            assert (app.order, str(table.border_subtitle)) == (order, edge), key


async def test_letters_of_the_filter_are_no_keys() -> None:
    app = SortedApp()
    async with app.run_test(size=(40, 10)) as pilot:
        table = app.query_one(RowTable)
        table.focus()
        await pilot.press("slash", "s", "C", "enter", "s")
        await pilot.pause()
        assert (table.typed, app.clipboard) == ("sC", "")
        await pilot.press("escape")
        await pilot.pause()
        # The key behind Enter has sorted.
        assert app.order == "Abcd"
