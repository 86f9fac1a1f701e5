"""The screen Setup."""

from textual.app import ComposeResult
from textual.widgets import Static

from app.tui.screens.base import MainScreen


class SetupScreen(MainScreen):
    """Under construction by its own commit."""

    PLACE = "setup"

    def body(self) -> ComposeResult:
        """Return nothing yet."""
        yield Static("Setup")
