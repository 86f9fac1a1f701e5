"""The screen Runs."""

from textual.app import ComposeResult
from textual.widgets import Static

from app.tui.screens.base import MainScreen


class RunsScreen(MainScreen):
    """Under construction by its own commit."""

    PLACE = "runs"

    def body(self) -> ComposeResult:
        """Return nothing yet."""
        yield Static("Runs")
