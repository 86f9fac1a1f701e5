"""Lines of raw traffic, the newest below; they stand still while somebody reads."""

from collections import deque
from collections.abc import Iterable
from itertools import islice
from typing import TYPE_CHECKING, Final

from rich.segment import Segment
from rich.style import Style
from textual.events import Resize
from textual.geometry import Size
from textual.scroll_view import ScrollView
from textual.strip import Strip

from catseye.app.tui.wire_lines import Row, ShownLine, bytes_a_row, rows_of, shown_line

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.bench import WireLine

_HEAD: Final = Style(dim=True)
_INKS: Final = {
    "tx": Style(color="cyan", bold=True),
    "rx": Style(color="green"),
    "heal": Style(color="yellow", bold=True),
}


class WireView(ScrollView, can_focus=True):
    """Shows what passes a filter.

    Attributes:
        following: new lines are shown as they come.
        waiting: lines that came since it stands still.
    """

    DEFAULT_CSS = """
    WireView { height: 1fr; scrollbar-size-vertical: 1; overflow-x: hidden; overflow-y: scroll; }
    """

    def __init__(self, *, id: str | None = None) -> None:
        super().__init__(id=id)
        self.following = True
        self.waiting = 0
        self._lines: deque[ShownLine] = deque(maxlen=5000)
        self._rows: list[Row] = []
        self._seen = 0
        self._device = ""
        self._part = ""

    @property
    def lines(self) -> list[ShownLine]:
        """What passes the filter, oldest first."""
        return [line for line in self._lines if line.fits(self._device, self._part)]

    @property
    def visible_text(self) -> str:
        """The rows in sight."""
        top = self.scroll_offset.y
        return "\n".join(row.plain for row in self._rows[top : top + self.size.height])

    def take(self, wire: "deque[WireLine]", seen: int) -> None:
        """Show what is new.

        Args:
            wire: traffic, oldest first; the oldest lines may be gone.
            seen: lines ever.
        """
        new = min(seen - self._seen, len(wire))
        if new <= 0:
            return
        self._seen = seen
        come = [shown_line(line) for line in islice(wire, len(wire) - new, None)]
        self._lines.extend(come)
        if not self.following:
            self.waiting += sum(line.fits(self._device, self._part) for line in come)
            return
        self._rows += self._rows_of(line for line in come if line.fits(self._device, self._part))
        if len(self._rows) > 4 * (self._lines.maxlen or 0):
            self._rows = self._rows[-2 * (self._lines.maxlen or 0) :]
        self._extend()

    def choose(self, device: str, part: str) -> None:
        """Show one device, or what holds a text or hex digits."""
        self._device, self._part = device, part.strip().lower()
        self._show_all()

    def follow(self, following: bool) -> None:
        """Show new lines as they come, or stand still."""
        self.following = following
        if following:
            self._show_all()

    def clear(self) -> None:
        """Forget all lines."""
        self._lines.clear()
        self._show_all()

    def action_scroll_up(self) -> None:
        """Read on upwards: the lines stand still."""
        self.following = False
        self.scroll_up(animate=False)

    def action_page_up(self) -> None:
        """Read a page up: the lines stand still."""
        self.following = False
        self.scroll_page_up(animate=False)

    def action_scroll_home(self) -> None:
        """Go to the oldest line: the lines stand still."""
        self.following = False
        self.scroll_home(animate=False)

    def action_scroll_end(self) -> None:
        """Go to the newest line, and follow."""
        self.follow(True)

    def on_mouse_scroll_up(self) -> None:
        """Stand still for whoever turns the wheel."""
        self.following = False

    def on_resize(self, _event: Resize) -> None:
        """Put more or fewer bytes into a row."""
        self._show_all()

    def render_line(self, y: int) -> Strip:
        """Return one row."""
        at = y + self.scroll_offset.y
        if not 0 <= at < len(self._rows):
            return Strip.blank(self.size.width, self.rich_style)
        row = self._rows[at]
        ink = _INKS[row.dir]
        parts = [
            Segment(f"{row.head} ", _HEAD),
            Segment(f"{row.arrow} ", ink),
            Segment(f"{row.hex} ", ink),
            Segment(row.text),
        ]
        strip = Strip(parts).crop_extend(0, self.size.width, self.rich_style)
        return strip.apply_style(self.rich_style)

    def _rows_of(self, lines: Iterable[ShownLine]) -> list[Row]:
        return list(rows_of(lines, bytes_a_row(self.size.width)))

    def _show_all(self) -> None:
        self.waiting = 0
        self._rows = self._rows_of(self.lines)
        self._extend()

    def _extend(self) -> None:
        self.virtual_size = Size(self.size.width, len(self._rows))
        if self.following:
            self.scroll_end(animate=False)
        self.refresh()
