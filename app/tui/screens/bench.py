"""The screen Bench."""

from textual.app import ComposeResult
from textual.widgets import Static

from app.tui.screens.base import MainScreen


class BenchScreen(MainScreen):
    """Under construction by its own commit."""

    PLACE = "bench"

    def body(self) -> ComposeResult:
        """Return nothing yet."""
        yield Static("Bench")
