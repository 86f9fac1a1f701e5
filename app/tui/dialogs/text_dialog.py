"""A text that can be read at leisure and copied."""

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical, VerticalScroll
from textual.screen import ModalScreen
from textual.widgets import Footer, Label, Static


class TextDialog(ModalScreen[None]):
    """Facts about one thing.

    Args:
        title: what it is about.
        text: lines.
    """

    DEFAULT_CSS = """
    TextDialog { align: center middle; }
    TextDialog > Vertical {
        width: 76; max-width: 95%; height: auto; max-height: 90%;
        border: heavy $primary; background: $surface; padding: 0 1;
    }
    TextDialog Label { text-style: bold; color: $primary; width: 100%; }
    TextDialog VerticalScroll { height: auto; max-height: 18; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,enter", "dismiss_it", "close", id="dialog.close"),
        Binding("c", "copy", "copy the text", id="dialog.copy"),
    ]

    def __init__(self, title: str, text: str) -> None:
        super().__init__()
        self._title = title
        self._text = text

    def compose(self) -> ComposeResult:
        """Title and text."""
        with Vertical():
            yield Label(self._title, markup=False)
            with VerticalScroll():
                yield Static(self._text, markup=False)
            yield Footer(compact=True)

    def action_dismiss_it(self) -> None:
        """Close."""
        self.dismiss()

    def action_copy(self) -> None:
        """Put title and text on the clipboard."""
        self.app.copy_to_clipboard(f"{self._title}\n{self._text}")
        self.notify("copied")
