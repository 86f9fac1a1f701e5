"""A rehearsal and what it found: totals and warnings, the table of its steps, and what will be asked."""

from typing import TYPE_CHECKING, Final

from textual.app import ComposeResult
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import Log

from catseye.app.render.text import block_lines, table_text
from catseye.app.results.rehearsal import rehearsal_report
from catseye.app.tui.rehearsing import Verdict
from catseye.app.tui.widgets.report_content import statement_content
from catseye.app.tui.widgets.static_text import StaticText, lines

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.rehearsal import Rehearsal

_SAID: Final = {
    "none": "not rehearsed with these parameters: Ctrl-R rehearses",
    "under way": "rehearsing …  Esc ends it",
    "ended": "ended before it was complete",
}


class RehearsalView(Vertical):
    """A rehearsal under way, or how it ended."""

    DEFAULT_CSS = """
    RehearsalView { height: 1fr; }
    RehearsalView #totals { height: auto; max-height: 7; }
    RehearsalView #head-line { height: 1; color: $primary; }
    RehearsalView #table { height: 1fr; scrollbar-size: 1 1; background: $background; }
    """

    def __init__(self, id: str) -> None:  # Textual's name for it
        super().__init__(id=id)
        self._shown: Verdict | None = None

    def compose(self) -> ComposeResult:
        """Put the parts together."""
        yield StaticText(id="totals")
        yield StaticText(id="head-line")
        yield Log(id="table", auto_scroll=False)

    def show(self, verdict: Verdict) -> None:
        """Show how far a rehearsal is, or what it found."""
        if verdict == self._shown:
            return
        self._shown = verdict
        if verdict.state == "found" and verdict.rehearsal is not None:
            self._show(verdict.rehearsal, verdict.stale)
            return
        self.query_one(Log).clear()
        self.query_one("#head-line", StaticText).set_text(Content(""))
        self._say(
            Content.styled(f"✗ {verdict.stale}{verdict.fault}", "$error")
            if verdict.state == "refused"
            else Content(_SAID[verdict.state])
        )

    def _show(self, rehearsal: "Rehearsal", stale: str) -> None:
        report = rehearsal_report(rehearsal)
        head_line, _, *rows = table_text(report.table("steps")).splitlines()
        self.query_one("#head-line", StaticText).set_text(Content(head_line))
        questions = (line for block in report.section("questions").blocks for line in block_lines(block))
        self.query_one(Log).clear()
        self.query_one(Log).write_lines([*rows, *questions], scroll_end=False)
        marked = [Content.styled(f"! {stale}Ctrl-R does it again", "$warning")] if stale else []
        self._say(lines(*marked, *map(statement_content, report.statements())))

    def _say(self, text: Content) -> None:
        self.query_one("#totals", StaticText).set_text(text)
