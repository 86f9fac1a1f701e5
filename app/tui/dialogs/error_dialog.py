"""What went wrong: title, cause, remedy; the text can be copied."""

from textual.app import ComposeResult
from textual.containers import VerticalScroll
from textual.widgets import Static

from catseye.app.tui.dialogs.message_dialog import MessageDialog


class ErrorDialog(MessageDialog):
    """An error that the user has to know of.

    Args:
        text: cause and remedy, as the engine or a command has given them.
    """

    DEFAULT_CSS = """
    ErrorDialog > Vertical { width: 76; max-height: 85%; border: heavy $error; }
    ErrorDialog Label { color: $error; }
    ErrorDialog VerticalScroll { height: auto; max-height: 14; }
    ErrorDialog .remedy { color: $success; margin-top: 1; }
    """

    @property
    def shown(self) -> tuple[str, str]:
        """Title and text."""
        return self._title, self._text

    def body(self) -> ComposeResult:
        """Cause and remedy stand apart where the text has both."""
        cause, remedy = split_remedy(self._text)
        with VerticalScroll(can_focus=False):
            yield Static(cause, markup=False, classes="cause")
            if remedy:
                yield Static(f"→ {remedy}", markup=False, classes="remedy")


def split_remedy(text: str) -> tuple[str, str]:
    """Return cause and remedy: the texts of this program put what to do behind the last colon or semicolon."""
    if "\n" in text:
        # A list of faults has no remedy of its own.
        return text, ""
    for mark in sorted((": ", "; "), key=text.rfind, reverse=True):
        cause, found, remedy = text.rpartition(mark)
        if found and remedy and remedy[0].islower():
            return cause, remedy
    return text, ""
