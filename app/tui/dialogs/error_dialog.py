"""What went wrong: title, cause, remedy; the text can be copied."""

from textual.app import ComposeResult
from textual.containers import Vertical, VerticalScroll
from textual.widgets import Label, Static

from catseye.app.tui.dialogs.message_dialog import MessageDialog
from catseye.app.tui.widgets.key_line import KeyLine


class ErrorDialog(MessageDialog):
    """An error that the user has to know of.

    Args:
        title: what could not be done.
        text: cause and remedy, as the engine or a command has given them.
    """

    DEFAULT_CSS = """
    ErrorDialog { align: center middle; }
    ErrorDialog > Vertical {
        width: 76; max-width: 95%; height: auto; max-height: 85%;
        border: heavy $error; background: $surface; padding: 0 1;
    }
    ErrorDialog Label { text-style: bold; color: $error; width: 100%; }
    ErrorDialog VerticalScroll { height: auto; max-height: 14; }
    ErrorDialog .remedy { color: $success; margin-top: 1; }
    """

    @property
    def shown(self) -> tuple[str, str]:
        """Title and text."""
        return self._title, self._text

    def compose(self) -> ComposeResult:
        """Cause and remedy stand apart where the text has both."""
        cause, remedy = split_remedy(self._text)
        with Vertical():
            yield Label(self._title, markup=False)
            with VerticalScroll(can_focus=False):
                yield Static(cause, markup=False, classes="cause")
                if remedy:
                    yield Static(f"→ {remedy}", markup=False, classes="remedy")
            yield KeyLine()


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
