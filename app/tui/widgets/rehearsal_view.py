"""A rehearsal and what it found: totals and warnings, the table of its steps, and what will be asked."""

from typing import TYPE_CHECKING

from textual.app import ComposeResult
from textual.containers import Vertical
from textual.content import Content
from textual.widgets import Log

from catseye.app.render.text import block_lines, table_text
from catseye.app.results.rehearsal import rehearsal_report
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.report_content import statement_content
from catseye.app.tui.widgets.static_text import StaticText, lines
from catseye.app.tui.work import Done

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.rehearsal import Rehearsal
    from catseye.app.protocol.requests import Start


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

    async def rehearse(self, session: Session, request: "Start") -> "Rehearsal | None":
        """Go through a procedure without any device; return what that found, None where it failed.

        Args:
            request: would start the procedure.
        """
        from catseye.app.protocol.rehearsal import Rehearsal

        words = ["run", request.procedure, "--cell", request.cell or "", "--runs", str(session.root)]
        words += ["--search", request.search, "--dry-run", "--json"]
        for text in request.params:
            words += ["--param", text]
        self._begin()
        done: Done | None = None
        try:
            done = await session.work.do(*words)
        finally:
            if done is None or done.code:
                self._show_fault("" if done is None else done.fault)
        if done.code:
            return None
        found = Rehearsal.model_validate_json(done.out)
        self._show(found)
        return found

    def _begin(self) -> None:
        self.query_one(Log).clear()
        self.query_one("#head-line", StaticText).set_text(Content(""))
        self._say(Content("going through it …  Esc ends that"))

    def _show_fault(self, text: str) -> None:
        """Say why there is none; empty where it was ended before."""
        self._say(Content.styled(f"✗ {text}", "$error") if text else Content("ended before it was complete"))

    def _show(self, rehearsal: "Rehearsal") -> None:
        report = rehearsal_report(rehearsal)
        head_line, _, *rows = table_text(report.table("steps")).splitlines()
        self.query_one("#head-line", StaticText).set_text(Content(head_line))
        questions = (line for block in report.section("questions").blocks for line in block_lines(block))
        self.query_one(Log).write_lines([*rows, *questions], scroll_end=False)
        self._say(lines(*map(statement_content, report.statements())))

    def _say(self, text: Content) -> None:
        self.query_one("#totals", StaticText).set_text(text)
