"""A list that is searched by typing."""

from dataclasses import dataclass
from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.content import Content
from textual.widgets import Input, OptionList
from textual.widgets.option_list import Option

from catseye.app.tui.dialogs.box_dialog import BoxDialog
from catseye.app.tui.widgets.static_text import StaticText


@dataclass(frozen=True)
class Found:
    """A line of the list.

    Attributes:
        id: what the dialog closes with.
        name: in bold.
        text: what it is or does.
        part: of the list that it belongs to.
    """

    id: str
    name: str
    text: str
    part: str = ""


class SearchDialog(BoxDialog[str | None]):
    """Every word that is typed has to occur; Enter closes with the line under the cursor, Esc with none.

    Args:
        entries: of the list, in the order of their parts.
        note: below the list.
        width: of the names.
    """

    DEFAULT_CSS = """
    SearchDialog > Vertical { width: 96; height: 90%; }
    SearchDialog Input { background: $boost; height: 1; border: none; padding: 0; }
    SearchDialog OptionList { height: 1fr; border: none; padding: 0; background: $surface; }
    SearchDialog StaticText { height: auto; color: $text-muted; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape", "close", "close", id="search.close"),
        Binding("enter", "take", "choose", id="search.take", show=False, priority=True),
        Binding("up", "move('cursor_up')", "up", show=False, priority=True, id="search.up"),
        Binding("down", "move('cursor_down')", "down", show=False, priority=True, id="search.down"),
        Binding("pageup", "move('page_up')", "page up", show=False, priority=True, id="search.page-up"),
        Binding(
            "pagedown", "move('page_down')", "page down", show=False, priority=True, id="search.page-down"
        ),
    ]

    def __init__(self, title: str, entries: tuple[Found, ...], note: str, width: int) -> None:
        super().__init__(title, note)
        self._entries = entries
        self._width = width

    def body(self) -> ComposeResult:
        """What is typed, the list, and how many there are."""
        yield Input(placeholder="type to search", compact=True)
        yield OptionList(compact=True, markup=False)
        yield StaticText()

    def on_mount(self) -> None:
        """Show all."""
        self._fill("")

    def on_input_changed(self, event: Input.Changed) -> None:
        """Show what is searched."""
        event.stop()
        self._fill(event.value)

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Close with the line that was clicked."""
        event.stop()
        self.dismiss(event.option_id)

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Open no list above a list."""
        return action not in ("help", "keys") and super().check_action(action, parameters)

    def action_move(self, how: str) -> None:
        """Move the cursor; what is typed keeps the focus."""
        getattr(self.query_one(OptionList), f"action_{how}")()

    def action_take(self) -> None:
        """Close with the line under the cursor."""
        self.query_one(OptionList).action_select()

    def action_close(self) -> None:
        """Close without one."""
        self.dismiss(None)

    def _fill(self, typed: str) -> None:
        words = typed.lower().split()
        shown = [
            one for one in self._entries if all(word in f"{one.name} {one.text}".lower() for word in words)
        ]
        options = self.query_one(OptionList)
        options.clear_options()
        part = ""
        for one in shown:
            if one.part != part:
                part = one.part
                options.add_option(Option(Content.styled(part, "bold $primary"), disabled=True))
            name = f"{one.name:<{self._width}} "
            options.add_option(Option(Content.assemble((name, "bold $accent"), one.text), id=one.id))
        options.action_first()
        self.query_one(StaticText).set_text(Content(f"{len(shown)} of {len(self._entries)}  {self._text}"))
