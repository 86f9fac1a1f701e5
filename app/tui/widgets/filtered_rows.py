"""Rows that a filter leaves: it is typed straight into the list or table, and stands on its lower edge."""

from typing import ClassVar

from textual.binding import Binding, BindingType
from textual.events import Key
from textual.message import Message
from textual.widget import Widget

from catseye.app.tui.widgets.frame_text import set_subtitle

_CURSOR = "▏"


class FilteredRows(Widget):
    """`/` begins, every key shows at once what it leaves; Enter goes back to the rows, Esc shows all of them.

    Whoever fills the list asks `passes` of each row, and fills it anew at each `Rearranged`. It stands behind the
    kind of list among the bases: Textual takes styles from the first one alone.
    """

    class Rearranged(Message):
        """Other rows, or another order of them, were asked for."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(
            "slash",
            "filter",
            "filter",
            key_display="/",
            id="table.filter",
            tooltip="shows rows that contain every word you type; Enter goes back to the rows, Esc shows all",
        ),
        Binding(
            "escape", "unfilter", "all rows", show=False, id="table.unfilter", tooltip="clears the filter"
        ),
    ]

    typed: str = ""
    typing: bool = False

    def passes(self, row: str) -> bool:
        """Return whether a row has every word that is typed."""
        text = row.casefold()
        return all(word in text for word in self.typed.casefold().split())

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Leave Esc to the screen while every row is shown."""
        return (action != "unfilter" or self.typing or bool(self.typed)) and super().check_action(
            action, parameters
        )

    def check_consume_key(self, key: str, character: str | None) -> bool:
        """Return whether a key belongs to the filter, and to nothing else on the screen."""
        del key
        return self.typing and character is not None and character.isprintable()

    def action_filter(self) -> None:
        """Type a filter; what was typed before stays."""
        self._show_filter(typing=True)

    def action_unfilter(self) -> None:
        """Show all rows."""
        self._take("")
        self._show_filter(typing=False)

    def on_key(self, event: Key) -> None:
        """Take what is typed before a key of the screen does."""
        if not self.typing:
            return
        if event.key == "enter":
            self._show_filter(typing=False)
        elif event.key == "backspace":
            self._take(self.typed[:-1])
        elif event.is_printable and event.character is not None:
            self._take(self.typed + event.character)
        else:
            return
        event.prevent_default()
        event.stop()

    def on_blur(self) -> None:
        """End typing; what was typed stays."""
        if self.typing:
            self._show_filter(typing=False)

    def _take(self, typed: str) -> None:
        changed, self.typed = typed != self.typed, typed
        self._show_filter(typing=self.typing)
        if changed:
            self.post_message(self.Rearranged())

    def _show_filter(self, *, typing: bool) -> None:
        self.typing = typing
        shown = typing or bool(self.typed)
        self.set_class(shown, "-filtered")
        set_subtitle(self, f"/ {self.typed}{_CURSOR if typing else '  Esc: all'}" if shown else "")
        self.refresh_bindings()
