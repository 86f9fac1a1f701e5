"""One line with the main screens and their keys; the one that is shown stands out."""

from rich.text import Text
from textual.app import RenderResult
from textual.events import Click
from textual.widget import Widget

from catseye.app.tui.main_screens import MAIN_SCREENS


class ScreenBar(Widget):
    """Names of the main screens.

    Args:
        current: name of the one that is shown.
    """

    DEFAULT_CSS = """
    ScreenBar { height: 1; background: $surface; }
    """

    def __init__(self, current: str) -> None:
        super().__init__()
        self._current = current

    def render(self) -> RenderResult:
        """Return the line."""
        text = Text(no_wrap=True, overflow="ellipsis")
        for name, entry in MAIN_SCREENS.items():
            shown = name == self._current
            text.append(entry.key.upper(), "bold reverse" if shown else "bold")
            text.append(f" {entry.title}", "reverse" if shown else "")
            text.append(" ")
        return text

    async def on_click(self, event: Click) -> None:
        """Show the screen that was clicked."""
        start = 0
        for name, entry in MAIN_SCREENS.items():
            end = start + len(entry.key) + 1 + len(entry.title)
            if start <= event.x < end:
                await self.run_action(f"app.go('{name}')")
                return
            start = end + 1
