"""The screen Runs: history with filter; timeline, resume, verify, report, export, identify, attach."""

import asyncio
from collections.abc import Iterable
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final

from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, VerticalScroll
from textual.content import Content

from catseye.app.service.command_process import Done, command_line
from catseye.app.tui.dialogs.form_dialog import Answers, Field, FormDialog
from catseye.app.tui.dialogs.text_dialog import TextDialog
from catseye.app.tui.previewed import previewed_run
from catseye.app.tui.resuming import ask_to_resume
from catseye.app.tui.run_rows import STATES, cells, columns, searched_words
from catseye.app.tui.screens.looking import LookingScreen
from catseye.app.tui.screens.working import free_name, typed_path, why_not_written
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.frame_text import set_title
from catseye.app.tui.widgets.preview import Preview
from catseye.app.tui.widgets.row_table import RowTable
from catseye.app.tui.widgets.static_text import StaticText
from catseye.app.tui.widgets.task_line import TaskLine

if TYPE_CHECKING:
    # The first screen is painted before the store is imported.
    from catseye.app.store.history import RunHistory, RunLine

_BATCH: Final = 100
"""Runs that are read, or put into the table, before the screen is painted again."""

_WIDE: Final = 100
_HIGH: Final = 34
_NOT_RESUMED: Final = {
    "complete": "it is complete: start a new run",
    "running": "it is under way: a attaches to it",
    "damaged": "it cannot be read: k says what is wrong",
}


class RunsScreen(LookingScreen):
    """A table of all runs; below it, or in its place where there is little room, the timeline of one."""

    SCREEN = "runs"
    look_s = 2.0
    AUTO_FOCUS = "#table"

    DEFAULT_CSS = """
    RunsScreen #count { height: 1; padding: 0 1; color: $text-muted; }
    RunsScreen #table { height: 1fr; background: $background; scrollbar-size: 1 1; padding: 0 0 0 1; }
    RunsScreen #rows { height: 1fr; }
    RunsScreen .aside { display: none; width: 1fr; }
    RunsScreen.-huge .aside { display: block; }
    RunsScreen.-huge #table { width: 104; }
    RunsScreen #timeline-panel { height: 1fr; display: none; scrollbar-size-vertical: 1; }
    RunsScreen.timeline #timeline-panel { display: block; }
    RunsScreen.timeline.-low #rows { display: none; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(
            "f",
            "state",
            "state",
            id="runs.state",
            tooltip="shows runs of one state only; each press takes the next state",
        ),
        Binding(
            "space", "mark", "mark", id="runs.mark", tooltip="marks the run, to identify from several runs"
        ),
        Binding(
            "r",
            "resume",
            "resume",
            id="runs.resume",
            tooltip="continues the run where it stopped; F8 there starts it",
        ),
        Binding("k", "verify", "verify", id="runs.verify", tooltip="checks whether the record was changed"),
        Binding(
            "i",
            "identify",
            "identify",
            id="runs.identify",
            tooltip="identifies from this run or the marked ones",
        ),
        Binding("p", "report", "page", id="runs.report", tooltip="writes the report, one HTML page"),
        Binding("o", "open_page", "open", id="runs.open", tooltip="opens the last report in the browser"),
        Binding("e", "export", "export", id="runs.export", tooltip="writes the rows for other programs"),
        Binding("a", "attach", "attach", id="runs.attach", tooltip="shows a run under way"),
        Binding("escape", "back", "back", show=False, id="runs.back", tooltip="leaves the timeline; cancels"),
    ]

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (160, "-huge")]
        self.VERTICAL_BREAKPOINTS = [(0, "-low"), (_HIGH, "-high")]
        self._history: RunHistory | None = None
        self._lines: dict[str, RunLine] = {}
        self._looked = False
        self._marked: set[str] = set()
        self._state = ""
        self._wide = True

    def body(self) -> ComposeResult:
        """Count, table, timeline."""
        yield StaticText(id="count")
        with Horizontal(id="rows"):
            yield RowTable(id="table")
            yield Preview(id="preview", classes="aside")
        with VerticalScroll(id="timeline-panel", classes="panel"):
            yield StaticText(id="timeline")
        yield TaskLine(self.session.now_s)

    def commands(self) -> Iterable[SystemCommand]:
        """Return what this screen can do."""
        yield SystemCommand("Filter the runs", "by words of a row", self.action_filter)
        yield SystemCommand("Runs of one state", "complete, stopped, died, …", self.action_state)
        yield SystemCommand("Timeline of the run", "what happened, in order", self.action_timeline)
        yield SystemCommand("Mark the run", "for identifying from several", self.action_mark)
        yield SystemCommand("Resume the run", "continue it where it stopped", self.action_resume)
        yield SystemCommand("Verify the run", "checks whether the record was changed", self.action_verify)
        yield SystemCommand("Identify from runs", "this one, or the marked ones", self.action_identify)
        yield SystemCommand("Report of the run", "one HTML page", self.action_report)
        yield SystemCommand("Open the report", "in the system's browser", self.action_open_page)
        yield SystemCommand("Export the run", "CSV, JSON or Parquet", self.action_export)
        yield SystemCommand("Attach to the run", "that is under way", self.action_attach)
        yield SystemCommand("Cancel the work", "that is under way on this screen", self.action_cancel)

    def on_mount(self) -> None:
        """Make the columns; the rows come from a thread."""
        self._set_columns()

    def on_data_table_row_highlighted(self) -> None:
        """Show what the run under the cursor has found, where there is room."""
        line = self._lines.get(self._table.chosen)
        shown = None if line is None else partial(previewed_run, line.path)
        self.query_one(Preview).show_soon(shown)

    def on_resize(self) -> None:
        """Show dates in full where there is room."""
        if self.size.width and (self.size.width >= _WIDE) != self._wide:
            self._set_columns()
            self._fill()

    def on_data_table_row_selected(self) -> None:
        """Show the timeline of the run."""
        self.action_timeline()

    def action_filter(self) -> None:
        """Type a filter."""
        self.remove_class("timeline")
        self._table.focus()
        self._table.action_filter()

    def action_state(self) -> None:
        """Show runs of the next state only; after the last one all."""
        states = ["", *STATES]
        self._state = states[(states.index(self._state) + 1) % len(states)]
        self._fill()

    def action_mark(self) -> None:
        """Mark or unmark the run under the cursor, and go on to the next."""
        line = self._chosen()
        if line is None:
            return
        self._marked ^= {line.name}
        self._show_line(line)
        self._count()
        self._table.action_cursor_down()

    def action_back(self) -> None:
        """Leave the timeline, else cancel the work."""
        if self.has_class("timeline"):
            self.remove_class("timeline")
            self.query_one("#table").focus()
        else:
            self.action_cancel()

    def action_cancel(self) -> None:
        """Cancel the work."""
        self.cancel_work()

    def action_timeline(self) -> None:
        """Show what happened in the run."""
        line = self._chosen()
        if line is not None:
            self.spawn(partial(self._show_timeline, line), "timeline", exclusive=True)

    def action_resume(self) -> None:
        """Show what would go on; F8 there goes on."""
        line = self._chosen()
        if line is None:
            return
        if line.status in _NOT_RESUMED:
            self.catseye.show_error(f"{line.name} cannot go on", _NOT_RESUMED[line.status])
            return
        about = f"{line.status}, {line.rows} points stored"
        ask_to_resume(self.catseye, line.name, about, line.cell, simulated=line.simulated)

    def action_verify(self) -> None:
        """Check the record."""
        if (line := self._chosen()) is not None:
            self.let_work(
                f"verify {line.id}",
                f"{line.name} is not what was written",
                *("verify", line.name, "--runs", self.session.root, "--json"),
                done=self._verified,
            )

    def action_report(self) -> None:
        """Write the report."""
        if (line := self._chosen()) is not None:
            page = self._folder / f"report-{line.id}.html"
            self.let_work(
                f"report {line.id}",
                "The report was not written",
                *("report", line.name, "--runs", self.session.root, "-o", page),
                done=lambda _: self.show_written(page, "report"),
            )

    def action_export(self) -> None:
        """Ask for a file, and write the rows."""
        if (line := self._chosen()) is not None:
            file = free_name(self._folder / f"{line.procedure}-{line.id}.csv")
            fields = [Field("file", "file", str(file))]
            text = f"{line.name}: the file ends in .csv, .json or .parquet"
            dialog = FormDialog("Export", fields, text, lambda answers: why_not_written(answers["file"]))
            self.app.push_screen(dialog, partial(self._export, line))

    def action_identify(self) -> None:
        """Ask how, and identify the arm from the marked runs, or this one."""
        lines = self._marked_lines() or [line for line in (self._chosen(),) if line is not None]
        if not lines:
            return
        fields = [
            Field("model", "model", "error-map", ("error-map", "conventional")),
            Field(
                "uncertainty", "uncertainty", "jacobian", ("jacobian", "monte-carlo"), "monte-carlo: slower"
            ),
            Field("draws", "draws", "10000", hint="Monte Carlo only, 2000 or more"),
            Field("file", "result file", str(free_name(self._folder / f"result-{lines[0].id}.json"))),
        ]
        text = "from " + ", ".join(line.name for line in lines)
        dialog = FormDialog("Identify", fields, text, _identify_fault)
        self.app.push_screen(dialog, partial(self._identify, [line.name for line in lines]))

    def action_attach(self) -> None:
        """Watch the run under the cursor, if it is under way."""
        line, engine = self._chosen(), self.session.link.engine
        if line is None:
            return
        if engine.running and engine.run is not None and engine.run.name == line.name:
            self.catseye.action_go("run")
        elif line.status == "running":
            typed = command_line(("attach", line.name, "--runs", str(self.session.root)))
            text = f"{line.name} belongs to another engine. In another terminal:\n\n{typed}"
            self.app.push_screen(TextDialog("Attach", text))
        else:
            self.notify(f"{line.name} is {line.status}: nothing to attach to", markup=False)

    @property
    def _table(self) -> RowTable:
        return self.query_one("#table", RowTable)

    @property
    def _folder(self) -> Path:
        """Where results and pages go: beside the folder of runs."""
        return self.session.root.absolute().parent

    def _chosen(self) -> "RunLine | None":
        table = self._table
        if not table.row_count:
            self.notify("there is no run in the list")
            return None
        return self._lines.get(table.chosen)

    def _marked_lines(self) -> "list[RunLine]":
        return [line for name, line in sorted(self._lines.items()) if name in self._marked]

    def _export(self, line: "RunLine", answers: Answers | None) -> None:
        if answers is not None:
            file = typed_path(answers["file"])
            self.let_work(
                f"export {line.id}",
                "Nothing was exported",
                *("export", line.name, "--runs", self.session.root, "-o", file),
                done=lambda _: self.show_written(file, "export"),
            )

    def _identify(self, names: list[str], answers: Answers | None) -> None:
        if answers is None:
            return
        file = typed_path(answers["file"])
        how: list[str | Path] = ["--model", answers["model"], "--uncertainty", answers["uncertainty"]]
        if answers["uncertainty"] == "monte-carlo":
            how += ["--draws", answers["draws"]]
        self.let_work(
            "identify",
            "The arm was not identified",
            *("identify", *names, *how, "--runs", self.session.root, "-o", file),
            done=partial(self._identified, file),
        )

    def _verified(self, done: Done) -> None:
        from catseye.app.results.runs.documents import VerificationDocument
        from catseye.app.results.runs.reports import verification_report

        report = verification_report(VerificationDocument.model_validate_json(done.out))
        text = "\n".join(statement.text for statement in report.statements())
        self.notify(text, title="sound", markup=False)

    def _identified(self, file: Path, done: Done) -> None:
        del done
        marked = self._marked_lines()
        self._marked.clear()
        for line in marked:
            self._show_line(line)
        self._count()
        self.show_written(file, "identified; F6 shows it")

    async def _show_timeline(self, line: "RunLine") -> None:
        panel, timeline = self.query_one("#timeline-panel"), self.query_one("#timeline", StaticText)
        set_title(panel, f"Timeline of {line.id}")
        self.add_class("timeline")
        timeline.set_text(Content("…"))
        done = await self.session.work.do("show", line.name, "--runs", self.session.root)
        if done.code:
            timeline.set_text(Content.styled(f"✗ {done.fault}", "$error"))
        else:
            timeline.set_text(Content(done.out.rstrip()))
        panel.focus()

    def _set_columns(self) -> None:
        self._wide = not self.size.width or self.size.width >= _WIDE
        self._table.clear(columns=True)
        for name, width in columns(wide=self._wide):
            self._table.add_column("" if name == "mark" else name, width=width, key=name)

    async def look_once(self) -> None:
        """Look at the folder of the runs."""
        from catseye.app.store.history import RunHistory

        try:
            self._history = self._history or RunHistory(self.session.root)
            changes = self._history.changes()
            while lines := await asyncio.to_thread(lambda: list(islice(changes, _BATCH))):
                self._take(lines)
            gone = self._lines.keys() - {line.name for line in self._history.lines}
            for name in gone:
                del self._lines[name]
                self._marked.discard(name)
        finally:
            self.looking = False
        if gone or not self._looked:
            self._looked = True
            self._fill()

    def _take(self, lines: "list[RunLine]") -> None:
        """Take runs that are new or have changed."""
        new = [line for line in lines if line.name not in self._lines]
        states = [line for line in lines if line not in new and self._lines[line.name].status != line.status]
        self._lines |= {line.name: line for line in lines}
        for line in lines:
            self._show_line(line)
        if new or states:
            self._fill()

    def _show_line(self, line: "RunLine") -> None:
        """Show what has changed of a run in its row, where it has one."""
        table = self._table
        if line.name not in table.rows:
            return
        row = cells(line, marked=line.name in self._marked, wide=self._wide)
        for (name, _), cell in zip(columns(wide=self._wide), row, strict=True):
            table.update_cell(line.name, name, cell)

    def on_filtered_rows_rearranged(self) -> None:
        """Fill the table with what is asked for, in its order."""
        self._fill()

    def _fill(self) -> None:
        self.spawn(self._filled, "fill", exclusive=True)

    async def _filled(self) -> None:
        """Fill the table anew, newest first or as it is sorted; the cursor stays on its run."""
        table = self._table
        newest_first = sorted(self._lines.values(), key=lambda line: line.name, reverse=True)
        of_state = (line for line in newest_first if self._state in ("", line.status))
        shown = table.arranged(
            of_state, lambda line: cells(line, marked=line.name in self._marked, wide=True), searched_words
        )
        names = [line.name for line in shown]
        present = [str(key.value) for key in table.rows]
        chosen = table.chosen
        if names[: len(present)] != present:
            table.clear()
            present = []
        for first in range(len(present), len(shown), _BATCH):
            for line in shown[first : first + _BATCH]:
                row = cells(line, marked=line.name in self._marked, wide=self._wide)
                table.add_row(*row, key=line.name)
            await asyncio.sleep(0)
        if chosen in names and not (table.cursor_row < len(names) and names[table.cursor_row] == chosen):
            table.move_cursor(row=names.index(chosen))
        self._count()

    def _count(self) -> None:
        shown, known = self._table.row_count, len(self._lines)
        parts = [f"{shown} of {known} runs"]
        if self._state:
            sign, _ = STATES[self._state]
            parts.append(f"only {sign} {self._state}")
        if self._marked:
            parts.append(f"{len(self._marked)} marked")
        if not known:
            parts = [f"no runs in {self.session.root}" if self._looked else "looking …"]
        self.query_one("#count", StaticText).set_text(Content(" · ".join(parts)))


def _identify_fault(answers: Answers) -> str:
    if answers["uncertainty"] == "monte-carlo" and not answers["draws"].isdigit():
        return "draws is a whole number"
    return why_not_written(answers["file"])
