"""The screen Run."""

from textual.app import ComposeResult
from textual.widgets import Static

from app.tui.screens.base import MainScreen


class RunScreen(MainScreen):
    """Under construction by its own commit."""

    PLACE = "run"

    def body(self) -> ComposeResult:
        """Return nothing yet."""
        yield Static("Run")
