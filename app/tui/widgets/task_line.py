"""One line about a command under way: bar, time left, and the key that ends it."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from textual.content import Content

from catseye.app.results.numbers import duration_text
from catseye.app.tui.widgets.progress_line import bar
from catseye.app.tui.widgets.static_text import StaticText

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.commands import CommandEvent, CommandProgress

_REFRESH_S = 0.5
_SHORTEST_BAR = 8


class TaskLine(StaticText):
    """Hidden while nothing is under way.

    Args:
        now_s: monotonic time, s.
    """

    DEFAULT_CSS = """
    TaskLine { height: 1; padding: 0 1; background: $boost; display: none; }
    TaskLine { text-wrap: nowrap; text-overflow: ellipsis; }
    TaskLine.busy { display: block; }
    """

    def __init__(self, now_s: Callable[[], float]) -> None:
        super().__init__()
        self._now_s = now_s
        self._title = ""
        self._begun_s = 0.0
        self._progress: CommandProgress | None = None
        self._progress_s = 0.0

    def on_mount(self) -> None:
        """Count the time."""
        self.set_interval(_REFRESH_S, self._show)

    def begin(self, title: str) -> None:
        """Show that something has begun."""
        self._title, self._begun_s = title, self._now_s()
        self._progress = None
        self.add_class("busy")
        self._show()

    def hear(self, event: "CommandEvent") -> None:
        """Take what the command reports."""
        if event.kind == "progress":
            self._progress, self._progress_s = event, self._now_s()
            self._show()

    def ending(self) -> None:
        """Show that it is being cancelled."""
        self._title, self._progress = f"{self._title}: cancelling", None
        self._show()

    def end(self) -> None:
        """Show nothing."""
        self._title = ""
        self.remove_class("busy")

    def _show(self) -> None:
        if not self._title:
            return
        passed_s = self._now_s() - self._begun_s
        parts: list[Content | str | tuple[str, str]] = [(f"{self._title} ", "bold")]
        if self._progress is None:
            parts.append(f"… {passed_s:.0f} s")
        else:
            width = max(_SHORTEST_BAR, self.size.width // 6)
            share = self._progress.share
            parts += [(bar(share, width), "$primary"), f" {100.0 * share:.0f} %"]
            parts.append(f"  {self._left()}  {self._progress.text}")
        parts.append(("   Esc cancels", "$text-muted"))
        self.set_text(Content.assemble(*parts))

    def _left(self) -> str:
        """Return the time left: what the command said, less the time since."""
        if self._progress is None or self._progress.left_s is None:
            return "time left not known yet"
        left_s = round(self._progress.left_s - (self._now_s() - self._progress_s))
        if left_s <= 0 and self._progress.share < 1.0:
            return "takes longer than estimated"
        return f"{duration_text(max(left_s, 0), whole=True)} left"
