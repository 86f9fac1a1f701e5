"""The line of keys: what stands in it, and what a click does."""

from typing import ClassVar

from textual.app import App, ComposeResult
from textual.binding import Binding, BindingType

from catseye.app.tui.widgets.key_line import KeyLine


class _Keys(App[None]):
    """Two keys, one of which may be out of use, and those that do not show."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("a", "add", "add"),
        Binding("plus", "add", "add more"),
        Binding("b", "leave", "leave"),
        Binding("c", "add", "hidden", show=False),
        Binding("question_mark", "keys", "keys"),
    ]

    def __init__(self, *, usable: bool = True) -> None:
        super().__init__()
        self.done: list[str] = []
        self.usable = usable

    def compose(self) -> ComposeResult:
        yield KeyLine()

    def action_add(self) -> None:
        self.done.append("add")

    def action_leave(self) -> None:
        self.done.append("leave")

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        del parameters
        return True if self.usable or action != "leave" else None


async def test_help_stands_first_and_the_palette_at_the_right() -> None:
    app = _Keys()
    async with app.run_test(size=(40, 5)) as pilot:
        await pilot.pause()
        assert app.query_one(KeyLine).render().plain == "? keys a add b leave".ljust(28) + "▏^p palette"


async def test_the_palette_is_never_cut_off() -> None:
    app = _Keys()
    async with app.run_test(size=(26, 5)) as pilot:
        await pilot.pause()
        assert app.query_one(KeyLine).render().plain == "? keys a add b▏^p palette"


async def test_a_click_presses_the_key_under_it() -> None:
    app = _Keys()
    async with app.run_test(size=(40, 5)) as pilot:
        await pilot.pause()
        for column in (7, 12, 13, 19, 20, 25):
            await pilot.click(offset=(column, 4))
        await pilot.pause()
        # From the sign's first column to the last letter; the gaps between press nothing.
        assert app.done == ["add", "leave", "leave"]


async def test_a_key_out_of_use_is_dim_and_does_nothing() -> None:
    app = _Keys(usable=False)
    async with app.run_test(size=(40, 5)) as pilot:
        await pilot.pause()
        await pilot.click(offset=(14, 4))
        await pilot.pause()
        line = app.query_one(KeyLine).render()
        dim = {
            line.plain[part.start : part.end].strip()
            for part in line.spans
            if getattr(part.style, "dim", None)
        }
        assert (app.done, dim) == ([], {"b", "leave"})
