"""Bars of one line: the main screens, the parts of a screen, and HOLD, STOP and ABORT."""

from collections.abc import Sequence

from rich.text import Text
from textual.app import ComposeResult, RenderResult
from textual.containers import Horizontal
from textual.events import Click
from textual.geometry import Size
from textual.widget import Widget
from textual.widgets import Button, Static

from catseye.app.tui.engine_state import EngineState
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


class TabLine(Widget):
    """Titles of parts in one line, or in as many as they need.

    Args:
        titles: of the parts, in order; the first is shown by 1.
    """

    DEFAULT_CSS = """
    TabLine { height: auto; padding: 0 1; }
    """

    def __init__(self, titles: Sequence[str]) -> None:
        super().__init__()
        self._titles = tuple(titles)
        self._current = 0

    def show(self, current: int, titles: Sequence[str] | None = None) -> None:
        """Show which part is shown.

        Args:
            current: from 0.
            titles: of other parts than before; None keeps them.
        """
        self._current = current
        if titles is not None:
            self._titles = tuple(titles)
        self.refresh(layout=titles is not None)

    def get_content_height(self, container: Size, viewport: Size, width: int) -> int:
        """Return the lines that the titles need."""
        del container, viewport
        return len(self._lines(width))

    def render(self) -> RenderResult:
        """Return the lines."""
        text = Text(no_wrap=True, overflow="ellipsis")
        for number, places in enumerate(self._lines(self.content_size.width)):
            text.append("\n" if number else "")
            for place in places:
                shown = place == self._current
                text.append(f"{place + 1}", "bold reverse" if shown else "bold")
                text.append(f" {self._titles[place]}", "reverse" if shown else "")
                text.append(" ")
        return text

    async def on_click(self, event: Click) -> None:
        """Show the part that was clicked."""
        start, lines = 1, self._lines(self.content_size.width)
        for place in lines[event.y] if event.y < len(lines) else ():
            end = start + self._cells(place)
            if start <= event.x < end:
                await self.run_action(f"screen.part({place})")
                return
            start = end + 1

    def _lines(self, width: int) -> list[list[int]]:
        """Return the places that stand in each line."""
        lines: list[list[int]] = [[]]
        used = 0
        for place in range(len(self._titles)):
            cells = self._cells(place)
            if lines[-1] and used + cells > width:
                lines.append([])
                used = 0
            lines[-1].append(place)
            used += cells + 1
        return lines

    def _cells(self, place: int) -> int:
        return len(f"{place + 1} {self._titles[place]}")


class StopBar(Horizontal):
    """One line with the buttons of the stop ladder."""

    DEFAULT_CSS = """
    StopBar { height: 1; background: $panel; }
    StopBar Button { height: 1; min-width: 12; border: none; margin: 0 1 0 0; }
    StopBar #hold { background: $warning; color: $background; }
    StopBar #stop { background: $error; color: $background; text-style: bold; }
    StopBar #abort { background: $error-darken-2; color: auto; }
    StopBar Static { width: 1fr; color: $warning; }
    """

    def compose(self) -> ComposeResult:
        """Make the buttons; they are for the mouse, the keys work everywhere."""
        for name, label in (("hold", "HOLD h"), ("stop", "STOP F12"), ("abort", "ABORT")):
            button = Button(label, id=name, action=f"app.{name}", compact=True)
            button.can_focus = False
            yield button
        yield Static("The software stop is no emergency stop.", id="warning")

    def show(self, engine: EngineState) -> None:
        """Say what HOLD does now."""
        button = self.query_one("#hold", Button)
        button.label = "GO ON F8" if engine.held else "HOLD h"
        button.action = "app.ask_to_go_on" if engine.held else "app.hold"
