"""What follows on a run: what it came to, and the commands that work on it."""

import asyncio
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Final

from catseye.app.results.readiness.after_run import CLEAR, Advice, after_run
from catseye.app.results.readiness.run_files import NO_FILES
from catseye.app.tui.dialogs.form_dialog import Answers, Field, FormDialog
from catseye.app.tui.dialogs.text_dialog import TextDialog
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.resuming import ask_to_resume
from catseye.app.tui.run_findings import RunFindings
from catseye.app.tui.run_state import RunState
from catseye.app.tui.screens.working import PageScreen, free_name, typed_path
from catseye.app.tui.session import Session
from catseye.app.tui.stage_work import fault_of
from catseye.app.tui.widgets.run_end import RunEnd

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.commands import CommandEvent


_SHOWN_CHARACTERS: Final = 20_000
"""Of a file of commands: its head and its first rows."""


class EndedRunScreen(PageScreen):
    """A main screen whose body holds a `RunEnd`."""

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self._doing = ""
        self._findings: RunFindings | None = None

    def show_end(self, engine: EngineState) -> None:
        """Show how the run ended, and find out what it came to."""
        run = engine.run
        if self._findings is not None and (run is None or run.active or run.name != self._findings.run):
            self._findings, self._doing = None, ""
            self.workers.cancel_group(self, "findings")
        if run is not None and run.ended is not None and self._findings is None:
            self._findings = RunFindings(run.name, run.procedure, self.session.root)
            complete = run.ended.status == "complete"
            looking = self._findings.look(self.session.work, complete=complete, changed=self.show_now)
            self.run_worker(looking, group="findings", exclusive=True, exit_on_error=False)
        self.query_one(RunEnd).show(run, self._findings, self._advice(run), self._doing)

    def action_after(self, kind: str) -> None:
        """Do what is sensible after the end."""
        run = self.session.link.engine.run
        found = next((each for each in self._advice(run) if each.kind == kind), None)
        if found is None:
            self.notify(f"{kind}: not now", severity="warning")
        elif found is CLEAR:
            self.catseye.action_clear()
        elif kind == "resume" and run is not None:
            engine = self.session.link.engine
            simulated = run.simulated if run.simulated is not None else engine.bench_simulated
            ask_to_resume(self.catseye, run.name, run.title, engine.cell_name, simulated=simulated)
        elif found.shows is not None:
            self._show_file(found.shows)
        elif found.asks:
            fields = [Field(asked.name, asked.what, "", hint=asked.hint) for asked in found.asks]
            dialog = FormDialog(found.name, fields, found.text, fault_of)
            self.app.push_screen(dialog, partial(self._answered, found))
        elif found.writes is not None:
            self._let_do(found, found.writes)

    def _answered(self, advice: Advice, answers: Answers | None) -> None:
        """Do what was asked about."""
        if answers is None or advice.writes is None:
            return
        given = {f"{{{name}}}": str(typed_path(text)) for name, text in answers.items()}
        command = tuple(given.get(word, word) for word in advice.command)
        self._let_do(replace(advice, command=command), advice.writes)

    def _let_do(self, advice: Advice, wanted: Path) -> None:
        self.run_worker(self._do(advice, wanted), group="after", exclusive=True, exit_on_error=False)

    def _show_file(self, file: Path) -> None:
        """Show the beginning of a file of commands."""
        try:
            with file.open(encoding="utf-8", errors="replace") as opened:
                text = opened.read(_SHOWN_CHARACTERS)
        except OSError as error:
            self.catseye.show_error(f"{file.name} cannot be read", str(error))
        else:
            self.app.push_screen(TextDialog(file.name, f"{file}\n\n{text}"))

    def action_back(self) -> None:
        """End a command that was begun here."""
        self.workers.cancel_group(self, "after")

    def open_written(self) -> bool:
        """Show the page that was written of the run; return whether there is one."""
        page = None if self._findings is None else self._findings.page
        if page is None:
            return False
        self.show_page(page)
        return True

    def _advice(self, run: RunState | None) -> list[Advice]:
        if run is not None and run.active:
            return []
        first = [CLEAR] if self.session.link.engine.aborted else []
        if run is None or run.ended is None:
            return first
        found, status = self._findings, run.ended.status
        result, files = (None, NO_FILES) if found is None else (found.result, found.files)
        advice = after_run(
            run.procedure,
            status,
            run.name,
            self.session.root,
            result,
            files,
            self.session.cell,
            rejected=run.ended.rejected,
        )
        return [*first, *advice]

    async def _do(self, advice: Advice, wanted: Path) -> None:
        """Run a command; how far it is, is shown meanwhile."""
        findings = self._findings

        def hear(event: "CommandEvent") -> None:
            if event.kind == "progress":
                self._doing = f"{event.title} {event.share:.0%}  {event.text}   Esc ends it"

        self._doing = f"{advice.name} …  Esc ends it"
        file = await asyncio.to_thread(free_name, wanted)
        try:
            with self.session.at_work(advice.name):
                done = await self.session.work.do(*advice.command, "-o", file, heard=hear)
        finally:
            self._doing = ""
        if done.code:
            self.catseye.show_error(f"{advice.name} failed", done.fault)
            return
        self.notify(str(file), title=f"{advice.name}: written", markup=False)
        if advice.kind == "analyse":
            self.session.wanted = file
        if findings is not None:
            await findings.note_written(advice.name, file)
        self.show_now()
