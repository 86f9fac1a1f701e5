"""A text that can be read at leisure and copied."""

from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.widgets import Label, Static

from catseye.app.tui.dialogs.message_dialog import MessageDialog
from catseye.app.tui.widgets.key_line import KeyLine


class TextDialog(MessageDialog):
    """Facts about one thing."""

    DEFAULT_CSS = """
    TextDialog { align: center middle; }
    TextDialog > Vertical {
        width: 76; max-width: 95%; height: auto; max-height: 90%;
        border: heavy $primary; background: $surface; padding: 0 1;
    }
    TextDialog Label { text-style: bold; color: $primary; width: 100%; }
    TextDialog VerticalScroll { height: auto; max-height: 18; }
    """

    def compose(self) -> ComposeResult:
        """Title and text."""
        with Vertical():
            yield Label(self._title, markup=False)
            with VerticalScroll():
                yield Static(self._text, markup=False)
            yield KeyLine()
