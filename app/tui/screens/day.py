"""What the day's list does: Enter opens a stage, and commands on stored data work from here."""

from abc import abstractmethod
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from textual.content import Content

from catseye.app.results.readiness.stages import NO_RESULT, CellStage
from catseye.app.service.command_process import Done
from catseye.app.tui.dialogs.form_dialog import Answers, FormDialog
from catseye.app.tui.dialogs.questions import ConfirmDialog
from catseye.app.tui.resuming import ask_to_resume
from catseye.app.tui.screens.working import WorkScreen, free_name
from catseye.app.tui.stage_work import changes_text, fault_of, fields_of, words_of
from catseye.app.tui.widgets.day_list import DayList
from catseye.app.tui.widgets.static_text import StaticText

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.results.readiness.survey_document import LastRun


class DayScreen(WorkScreen):
    """A screen with a `DayList`, and a text `#work` about the stage under its cursor."""

    opens = "Enter on its stage opens it in the browser"

    @abstractmethod
    def show_procedure(self, name: str) -> "LastRun | None":
        """Show a procedure; return its last run."""

    @abstractmethod
    def action_start(self) -> None:
        """Show what of the procedure would begin; F8 there begins it."""

    @abstractmethod
    def show_work(self, title: str) -> None:
        """Show `#work` instead of a procedure."""

    @abstractmethod
    def look_again(self) -> None:
        """Look at the cell and its runs again."""

    def on_day_list_chosen(self, event: DayList.Chosen) -> None:
        """Show what a stage is for; of a procedure what it needs, too."""
        stage = event.stage
        if not self.query_one(DayList).has_focus:
            # Somebody works elsewhere on the screen.
            return
        if stage.procedure:
            self.show_procedure(stage.name)
            return
        how = _lacking(stage) or ("Enter shows it." if _is_shown(stage) else "Enter does it; nothing moves.")
        said = (stage.text, stage.found, "", how, "", stage.command)
        self.query_one("#work", StaticText).set_text(Content("\n".join(said)))
        self.show_work(stage.name)

    def on_day_list_opened(self, event: DayList.Opened) -> None:
        """Do a stage, or show what it gave; what moves the arm has a key of its own."""
        self.open_stage(event.stage)

    def open_stage(self, stage: CellStage) -> None:
        """Do a stage, or show what it gave."""
        if stage.procedure:
            self._open_procedure(stage)
        elif lacking := _lacking(stage):
            self.notify(f"{stage.name}: {lacking}", severity="warning", markup=False)
        elif stage.asks:
            dialog = FormDialog(stage.name, fields_of(stage), f"{stage.text}\n{stage.command}", fault_of)
            self.app.push_screen(dialog, partial(self._answered, stage))
        elif _is_shown(stage) and stage.shown is not None:
            self._show_output(stage.shown)
        elif stage.changes_cell:
            words = (*words_of(stage, {}), "--json")
            asking = partial(self._ask_to_change, stage)
            self.let_work(stage.name, f"{stage.name} failed", *words, done=asking)
        else:
            self._answered(stage, {})

    def _ask_to_change(self, stage: CellStage, preview: Done) -> None:
        """Show what would change in the cell file; y has it written."""

        def answered(agreed: bool | None) -> None:
            if agreed:
                words = (*words_of(stage, {}), "--yes")
                self.let_work(stage.name, f"{stage.name} failed", *words, done=partial(self._written, stage))

        dialog = ConfirmDialog("The error budget", changes_text(preview.out), "write it", "leave the file")
        self.app.push_screen(dialog, answered)

    def _open_procedure(self, stage: CellStage) -> None:
        last = self.show_procedure(stage.name)
        if stage.state != "done" and last is not None and last.resumable and not last.void:
            about = f"{last.status}, {last.age}; Esc here, and Ctrl-S begins it again"
            engine = self.session.link.engine
            ask_to_resume(self.catseye, last.name, about, engine.cell_name, simulated=engine.bench_simulated)
        else:
            self.action_start()

    def _answered(self, stage: CellStage, answers: Answers | None) -> None:
        if answers is None:
            return
        if stage.files and stage.output is not None:
            # What was written before may be in use.
            stage = stage.writing(free_name(stage.output))
        words = words_of(stage, answers)
        self.let_work(stage.name, f"{stage.name} failed", *words, done=partial(self._written, stage))

    def _written(self, stage: CellStage, done: Done) -> None:
        for text in done.warnings:
            self.notify(text, severity="warning", markup=False, timeout=10.0)
        if stage.output is not None:
            self.show_written(stage.output, stage.name)
        self.look_again()

    def _show_output(self, output: Path) -> None:
        """Show what a stage has written: a page in the browser, a result on its screen."""
        if output.suffix == ".html":
            self.show_page(output)
        elif output.suffix == ".json":
            self.session.wanted = output
            self.catseye.action_go("results")
        else:
            self.notify(str(output.absolute()), title="it is done", markup=False)


def _is_shown(stage: CellStage) -> bool:
    """Return whether a stage has nothing left to do, so that Enter shows what it wrote."""
    return stage.state in {"done", "failed"} and not stage.asks and stage.shown is not None


def _lacking(stage: CellStage) -> str:
    """Return what work on data waits for; empty where it can be done."""
    if stage.state == "left out":
        return stage.text
    if stage.state == "later" and not stage.runs:
        return "it waits for a complete run of an earlier stage"
    return "it waits for the result of an earlier stage" if NO_RESULT in stage.words else ""
