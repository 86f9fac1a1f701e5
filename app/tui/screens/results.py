"""The screen Results."""

from textual.app import ComposeResult
from textual.widgets import Static

from app.tui.screens.base import MainScreen


class ResultsScreen(MainScreen):
    """Under construction by its own commit."""

    PLACE = "results"

    def body(self) -> ComposeResult:
        """Return nothing yet."""
        yield Static("Results")
