"""The screen Jog."""

from textual.app import ComposeResult
from textual.widgets import Static

from app.tui.screens.base import MainScreen


class JogScreen(MainScreen):
    """Under construction by its own commit."""

    PLACE = "jog"

    def body(self) -> ComposeResult:
        """Return nothing yet."""
        yield Static("Jog")
