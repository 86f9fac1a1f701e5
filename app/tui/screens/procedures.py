"""The screen Procedures."""

from textual.app import ComposeResult
from textual.widgets import Static

from app.tui.screens.base import MainScreen


class ProceduresScreen(MainScreen):
    """Under construction by its own commit."""

    PLACE = "procedures"

    def body(self) -> ComposeResult:
        """Return nothing yet."""
        yield Static("Procedures")
