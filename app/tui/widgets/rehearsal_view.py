"""What a rehearsal found: totals and warnings, the table of its steps, and what will be asked."""

from typing import TYPE_CHECKING

from textual.app import ComposeResult
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import Log

from catseye.app.render.text import block_lines, table_text
from catseye.app.results.rehearsal import rehearsal_report
from catseye.app.tui.widgets.report_content import statement_content
from catseye.app.tui.widgets.static_text import StaticText, lines

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.rehearsal import Rehearsal


class RehearsalView(Vertical):
    """A rehearsal under way, or how it ended."""

    DEFAULT_CSS = """
    RehearsalView { height: 1fr; }
    RehearsalView #totals { height: auto; max-height: 7; }
    RehearsalView #head-line { height: 1; color: $primary; }
    RehearsalView #table { height: 1fr; scrollbar-size: 1 1; background: $background; }
    """

    def compose(self) -> ComposeResult:
        """Put the parts together."""
        yield StaticText(id="totals")
        yield StaticText(id="head-line")
        yield Log(id="table", auto_scroll=False)

    def begin(self) -> None:
        """Say that it is under way."""
        self.query_one(Log).clear()
        self.query_one("#head-line", StaticText).set_text(Content(""))
        self._say(Content("going through it …  Esc ends that"))

    def show_fault(self, text: str) -> None:
        """Say why there is none; empty where it was ended before."""
        self._say(Content.styled(f"✗ {text}", "$error") if text else Content("ended before it was complete"))

    def show(self, rehearsal: "Rehearsal") -> None:
        """Show what it found."""
        report = rehearsal_report(rehearsal)
        head_line, _, *rows = table_text(report.table("steps")).splitlines()
        self.query_one("#head-line", StaticText).set_text(Content(head_line))
        questions = (line for block in report.section("questions").blocks for line in block_lines(block))
        self.query_one(Log).write_lines([*rows, *questions], scroll_end=False)
        self._say(lines(*map(statement_content, report.statements())))

    def _say(self, text: Content) -> None:
        self.query_one("#totals", StaticText).set_text(text)
