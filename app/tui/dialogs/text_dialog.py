"""A text that can be read at leisure and copied."""

from textual.app import ComposeResult
from textual.containers import VerticalScroll

from catseye.app.tui.dialogs.message_dialog import MessageDialog


class TextDialog(MessageDialog):
    """Facts about one thing."""

    DEFAULT_CSS = """
    TextDialog > Vertical { width: 76; max-height: 90%; }
    TextDialog Label { color: $primary; }
    TextDialog VerticalScroll { height: auto; max-height: 18; }
    """

    def body(self) -> ComposeResult:
        """The text, which can be scrolled."""
        with VerticalScroll():
            yield from super().body()
