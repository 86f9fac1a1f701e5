"""The screen Terminal."""

from textual.app import ComposeResult
from textual.widgets import Static

from app.tui.screens.base import MainScreen


class TerminalScreen(MainScreen):
    """Under construction by its own commit."""

    PLACE = "terminal"

    def body(self) -> ComposeResult:
        """Return nothing yet."""
        yield Static("Terminal")
