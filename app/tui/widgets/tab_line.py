"""The parts of a screen in one line, with the digit that shows each."""

from collections.abc import Sequence

from rich.text import Text
from textual.app import RenderResult
from textual.events import Click
from textual.widget import Widget


class TabLine(Widget):
    """One line.

    Args:
        titles: of the parts, in order; the first is shown by 1.
    """

    DEFAULT_CSS = """
    TabLine { height: 1; padding: 0 1; }
    """

    def __init__(self, titles: Sequence[str]) -> None:
        super().__init__()
        self._titles = tuple(titles)
        self._current = 0

    def show(self, current: int) -> None:
        """Show which part is shown, from 0."""
        self._current = current
        self.refresh()

    def render(self) -> RenderResult:
        """Return the line."""
        text = Text(no_wrap=True, overflow="ellipsis")
        for place, title in enumerate(self._titles):
            shown = place == self._current
            text.append(f"{place + 1}", "bold reverse" if shown else "bold")
            text.append(f" {title}", "reverse" if shown else "")
            text.append(" ")
        return text

    async def on_click(self, event: Click) -> None:
        """Show the part that was clicked."""
        start = 1
        for place, title in enumerate(self._titles):
            end = start + 2 + len(title)
            if start <= event.x < end:
                await self.run_action(f"screen.part({place})")
                return
            start = end + 1
