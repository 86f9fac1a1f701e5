"""The screen Procedures: what can be done, what it needs, what comes next; parameters, rehearsal, start."""

from collections.abc import Iterable
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, Final

from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.content import Content
from textual.widgets import Button, ContentSwitcher, OptionList

from catseye.app.results.readiness.need import Need
from catseye.app.results.readiness.survey_report import readiness
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.screens.surveying import SurveyingScreen
from catseye.app.tui.serial.pose_choice import POSES, choose_poses, takes_chosen_poses
from catseye.app.tui.session import Session
from catseye.app.tui.start_text import (
    WALK_LINES,
    bench_needs,
    choice_lines,
    open_lines,
    speed_lines,
    start_rows,
)
from catseye.app.tui.widgets.day_list import DayList
from catseye.app.tui.widgets.explanation_view import ExplanationView
from catseye.app.tui.widgets.frame_text import set_subtitle, set_title
from catseye.app.tui.widgets.parameter_form import ParameterForm, Schema, with_run_fields
from catseye.app.tui.widgets.procedure_list import ProcedureList
from catseye.app.tui.widgets.rehearsal_view import RehearsalView
from catseye.app.tui.widgets.report_content import statement_content
from catseye.app.tui.widgets.static_text import StaticText, lines
from catseye.app.tui.widgets.task_line import TaskLine

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.requests import Start
    from catseye.app.results.readiness.stages import CellStage
    from catseye.app.results.readiness.survey_document import LastRun, ProcedureEntry

_WALK: Final = "drives the motions slowly while you hold Space; F8 in the dialog begins"
_PARTS: Final = {"form": "Parameters", "about": "What it does", "rehearsal": "Rehearsal", "work": "Command"}
_WAIT: Final = "reading cell and runs: wait a moment"


def _key(keys: str, action: str, label: str, tooltip: str, *, show: bool = True) -> Binding:
    return Binding(keys, action, label, show=show, id=f"procedures.{action}", tooltip=tooltip)


class ProceduresScreen(SurveyingScreen):
    """The day and all procedures at the left; at the right what the chosen one needs, its parameters, a rehearsal."""

    SCREEN = "procedures"
    AUTO_FOCUS = "#day"

    DEFAULT_CSS = """
    ProceduresScreen #left { width: 29; }
    ProceduresScreen #list { height: 1fr; border: none; padding: 0; background: $background; }
    ProceduresScreen #list { scrollbar-size-vertical: 1; }
    ProceduresScreen #list-panel { height: 1fr; min-height: 5; }
    ProceduresScreen #day-panel { height: auto; max-height: 60%; }
    ProceduresScreen #day { height: auto; max-height: 100%; }
    ProceduresScreen #needs { height: auto; max-height: 50%; }
    ProceduresScreen #needs StaticText { width: 1fr; }
    ProceduresScreen #what { height: 1fr; min-height: 8; }
    ProceduresScreen ContentSwitcher, ProceduresScreen #form, ProceduresScreen #rehearsal { height: 1fr; }
    ProceduresScreen #described { height: 2; color: $text-muted; }
    ProceduresScreen #buttons { height: 1; }
    ProceduresScreen #buttons Button { height: 1; min-width: 10; border: none; margin-right: 1; }
    ProceduresScreen #buttons StaticText { width: 1fr; color: $text-muted; }
    ProceduresScreen.-low #needs.rehearsal, ProceduresScreen.-low #explained,
    ProceduresScreen #explained.hidden { display: none; }
    ProceduresScreen #explained { max-height: 20; }
    ProceduresScreen #about { height: 1fr; }
    ProceduresScreen.-narrow #left { width: 26; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        _key("ctrl+r", "rehearse", "rehearse", "plans and checks the procedure without any device"),
        _key("ctrl+s", "start", "start …", "shows what will start; F8 there starts it"),
        _key("w", "walk", "walk …", _WALK, show=False),
        _key("v,ctrl+o", "view", "view", "shows parameters, description or rehearsal"),
        _key("j", "poses", "poses …", "chooses the poses that identify the arm best", show=False),
        _key(
            "n",
            "next",
            "next step",
            "opens the next stage on this cell, as Enter on the day's list does",
        ),
        _key("ctrl+u", "update", "update", "reads cell file and runs again", show=False),
        _key("escape", "back", "back", "ends the rehearsal; back to the list", show=False),
    ]

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (76, "-wide")]
        self.VERTICAL_BREAKPOINTS = [(0, "-low"), (32, "-high")]
        self._chosen = ""
        self._typed: dict[str, dict[str, str]] = {}
        self._of_bench: tuple[Need, ...] = ()
        self._real = False
        self._ended: object = None
        self._cell: Path | None = None
        self._listed: str | None = None
        self._fields: Schema = {}

    def body(self) -> ComposeResult:
        """Put the parts together."""
        with Horizontal():
            with Vertical(id="left"):
                with Vertical(id="day-panel", classes="panel") as panel:
                    panel.border_title = "The day"
                    yield DayList(id="day")
                with Vertical(id="list-panel", classes="panel") as panel:
                    panel.border_title = "Procedures"
                    yield ProcedureList(id="list")
            with Vertical(id="right"):
                with VerticalScroll(id="needs", classes="panel", can_focus=False):
                    yield StaticText(id="needed")
                with ExplanationView(id="explained", classes="panel", can_focus=False) as panel:
                    set_title(panel, _PARTS["about"])
                with Vertical(id="what", classes="panel"):
                    with ContentSwitcher(initial="form"):
                        with Vertical(id="form"):
                            yield ParameterForm()
                            yield StaticText(id="described")
                        yield ExplanationView(id="about")
                        yield RehearsalView(id="rehearsal")
                        yield StaticText(id="work")
                    with Horizontal(id="buttons"):
                        yield Button("Rehearse ^r", id="rehearse", action="screen.rehearse", compact=True)
                        yield Button("Walk … w", id="walk", action="screen.walk", compact=True)
                        yield Button("Start … ^s", id="start", action="screen.start", compact=True)
                        yield Button("Poses … j", id="poses", action="screen.poses", compact=True)
                        yield StaticText(id="doing")
        yield TaskLine(self.session.now_s)

    def commands(self) -> Iterable[SystemCommand]:
        """Return what this screen can do."""
        yield SystemCommand("Rehearse the procedure", "without any device", self.action_rehearse)
        yield SystemCommand("Start the procedure", "first shows what will start", self.action_start)
        yield SystemCommand("Walk the procedure through", "slowly, nothing measured", self.action_walk)
        yield SystemCommand("Parameters or rehearsal", "show the other one", self.action_view)
        yield SystemCommand("Choose poses", "and see the index against their number", self.action_poses)
        yield SystemCommand("Open the next step", "that is sensible on this cell", self.action_next)
        yield SystemCommand("End the rehearsal", "or back to the list", self.action_back)
        yield SystemCommand("Read cell and runs again", "needs, last runs, next step", self.action_update)

    def on_mount(self) -> None:
        """Ask what there is."""
        self.query_one("#what").border_title = "Parameters"
        self.action_update()

    def show_state(self, engine: EngineState, now_s: float) -> None:
        """Show whether the devices are there; look again after the end of a run."""
        del now_s
        needs = bench_needs(engine)
        real = engine.bench_simulated is False
        if needs != self._of_bench:
            was_gone = any(need.what == "devices" and need.met == "missing" for need in self._of_bench)
            is_back = any(need.what == "devices" and need.met == "met" for need in needs)
            self._of_bench = needs
            self._show_needs()
            if was_gone and is_back:
                # It may have been restarted, and nothing that was done on it holds.
                self.action_update()
        if real != self._real:
            self._real = real
            self._choose(self._chosen)
        ended = engine.run.ended if engine.run is not None else None
        if ended is not self._ended or self.session.cell != self._cell:
            self._ended = ended
            self.action_update()

    def action_update(self) -> None:
        """Look at the cell and its runs."""
        if self.session.cell != self._cell:
            # A search, and names of reflectors, are of one cell.
            self._cell, self._typed = self.session.cell, {}
            self._survey, self._chosen = None, ""
        self.rehearser.outdate("runs or cell may have changed since")
        self.run_worker(self.survey(), group="update", exclusive=True, exit_on_error=False)

    def action_poses(self) -> None:
        """Choose poses, and take them for the procedure."""
        if self._cell is None or not self._cell_name or not takes_chosen_poses(self._procedure):
            self.notify(
                "this procedure does not use chosen poses: select the calibration of an arm in the list",
                severity="warning",
            )
        else:
            form = self.query_one(ParameterForm)
            if not form.shows_faults():
                take = partial(form.fill, POSES)
                choose_poses(self._cell, self.session, self.app, form.typed, take)

    def action_next(self) -> None:
        """Open the next sensible stage."""
        stage = None if self._survey is None else self._survey.next
        if stage is not None:
            self.open_stage(stage)
        elif self._looking:
            self.notify(_WAIT, severity="warning")
        else:
            self.notify("every stage is done")

    def open_stage(self, stage: "CellStage") -> None:
        """Do a stage, or show what it gave, unless another one may be next by now."""
        if self._looking:
            self.notify(_WAIT, severity="warning")
        else:
            super().open_stage(stage)

    def show_procedure(self, name: str) -> "LastRun | None":
        """Choose a procedure in the list; return its last run."""
        self.query_one(ProcedureList).choose(name)
        self._choose(name)
        return None if self._procedure is None else self._procedure.last

    def show_work(self, title: str) -> None:
        """Show work on stored data, which is no procedure."""
        self._chosen = ""
        set_title(self.query_one("#needs"), title)
        self.query_one("#needed", StaticText).set_text(Content("work on stored data: nothing moves"))
        self._show_part("work")

    def look_again(self) -> None:
        """Look at the cell and its runs again."""
        self.action_update()

    def action_view(self) -> None:
        """Show parameters, what the procedure does, or what the rehearsal found."""
        if not self._chosen:
            self.notify("choose a procedure first: this step moves nothing", severity="warning")
            return
        # Where there is room, what it does stands above the parameters.
        parts = ("form", "about", "rehearsal") if self.has_class("-low") else ("form", "rehearsal")
        shown = self.query_one(ContentSwitcher).current
        self._show_part(parts[(parts.index(shown) + 1) % len(parts)] if shown in parts else "form")

    def action_back(self) -> None:
        """End what is under way, a command or a rehearsal; else leave the form."""
        if self.cancel_work():
            return
        if self.verdict.state == "under way":
            self.workers.cancel_group(self, "rehearsal")
        else:
            if self._chosen:
                self._show_part("form")
            self.query_one(DayList).focus()

    def action_rehearse(self) -> None:
        """Go through the procedure without any device."""
        if self._ready_to_go():
            self._show_part("rehearsal")
            self.rehearse()

    def action_start(self) -> None:
        """Show what would begin; F8 there begins it."""
        if self._cell_name and self.query_one(ParameterForm).is_filling:
            # Whoever has just chosen it need not wait for its fields.
            self.run_worker(self._start_once_filled(), group="start", exclusive=True, exit_on_error=False)
        elif self._ready_to_go():
            self._show_start(walk=False)

    async def _start_once_filled(self) -> None:
        await self.query_one(ParameterForm).filled()
        if self.is_current:
            self.action_start()

    def action_walk(self) -> None:
        """Show what would be walked; F8 there begins it, and Space, held, moves the arm then."""
        if self._ready_to_go():
            self._show_start(walk=True)

    def _show_start(self, *, walk: bool) -> None:
        procedure = self._procedure
        title = self._chosen if procedure is None else procedure.title
        request = self._request().model_copy(update={"walk": walk})
        self.show_start(request, f"Walk-through: {title}" if walk else title, self._cell_name)

    def on_option_list_option_highlighted(self, event: OptionList.OptionHighlighted) -> None:
        """Show another procedure."""
        if event.option.id is not None and event.option_list.has_focus:
            self._choose(event.option.id)

    def on_option_list_option_selected(self, event: OptionList.OptionSelected) -> None:
        """Go to its first parameter."""
        if event.option.id is not None:
            self.show_procedure(event.option.id)
            self._show_part("form")
            if rows := self.query_one(ParameterForm).rows:
                rows[0].query("Input, Select").first().focus()

    def on_parameter_row_changed(self) -> None:
        """Remember what was typed."""
        form = self.query_one(ParameterForm)
        if form.procedure:
            self._typed[form.procedure] = form.typed
        self._show_needs()
        self.rehearse_soon()

    def on_parameter_form_described(self, event: ParameterForm.Described) -> None:
        """Say what the field with the focus is."""
        self.query_one("#described", StaticText).set_text(Content(event.text))

    def show_listed(self) -> None:
        """Show what can be run before the next step is known."""
        self.show_survey()
        self._listed = self._chosen

    def show_survey(self) -> None:
        """Show the day and all procedures."""
        survey, listed = self._survey, self.query_one(ProcedureList)
        following = None if survey is None else survey.next
        if self._chosen == self._listed:
            # Nobody has chosen another one while the next step was unknown.
            self._chosen = ""
        self._listed = None
        chosen = self._chosen or ("" if following is None else following.name)
        entries = () if survey is None else survey.procedures
        listed.show_entries(entries, "" if following is None else following.name, known=bool(self._cell_name))
        self.query_one(DayList).show_stages(() if survey is None else survey.stages)
        names = [entry.name for entry in entries]
        if names and self.query_one(ContentSwitcher).current != "work":
            self.show_procedure(chosen if chosen in names else names[0])

    def on_filtered_rows_rearranged(self, event: ProcedureList.Rearranged) -> None:
        """Show the procedures that are asked for; the first of them where the chosen one is not among them."""
        event.stop()
        listed = self.query_one(ProcedureList)
        listed.fill()
        panel = self.query_one("#list-panel")
        set_title(panel, f"Procedures{' ▲' if listed.by_name else ''}")
        if names := listed.names:
            self.show_procedure(self._chosen if self._chosen in names else names[0])

    @property
    def _procedure(self) -> "ProcedureEntry | None":
        """What is chosen."""
        return None if self._survey is None else self._survey.procedure(self._chosen)

    def _choose(self, name: str) -> None:
        procedure = None if self._survey is None else self._survey.procedure(name)
        if procedure is None:
            return
        changed, self._chosen = name != self._chosen, name
        set_title(self.query_one("#needs"), procedure.title)
        self.query_one("#poses").display = takes_chosen_poses(procedure)
        for view in self.query(ExplanationView):
            view.show(procedure)
        if changed or self.query_one(ContentSwitcher).current == "work":
            self._show_part("form")
            self.query_one("#described", StaticText).set_text(Content(""))
        else:
            self._show_needs()
        fields = with_run_fields(procedure, self.session.speed, real=self._real)
        if not changed and fields == self._fields:
            # Somebody may be typing there.
            return
        self._fields = fields
        self.rehearse_soon()
        self.query_one(ParameterForm).show_parameters(
            name, fields, self._typed.get(name) or self._given(name)
        )

    def _show_needs(self) -> None:
        procedure = self._procedure
        if procedure is None:
            return
        if not self._cell_name and self._looking:
            self.query_one("#needed", StaticText).set_text(Content(self._looked))
            return
        verdict = self.verdict
        self.query_one(RehearsalView).show(verdict)
        # Where all of it is shown there is no need to say it twice.
        brief = () if self.query_one(ContentSwitcher).current == "rehearsal" else (verdict.need,)
        shown = readiness((*self._needs_of(procedure), *brief), procedure.last)
        self.query_one("#needed", StaticText).set_text(lines(*map(statement_content, shown)))

    def _show_part(self, part: str) -> None:
        self.query_one(ContentSwitcher).current = part
        self.query_one("#needs").set_class(part == "rehearsal", "rehearsal")
        self.query_one("#explained").set_class(part != "form", "hidden")
        set_title(self.query_one("#what"), _PARTS[part])
        self.query_one("#buttons").display = part != "work"
        if part != "work":
            self._show_needs()

    def _ready_to_go(self) -> bool:
        form = self.query_one(ParameterForm)
        if self.query_one(ContentSwitcher).current == "work":
            self.notify("this step moves nothing: Enter on the day's list does it", severity="warning")
        elif self.session.cell is None:
            self.notify("there is no cell file yet: set one up (F10)", severity="warning")
        elif not self._cell_name or form.procedure != self._chosen:
            self.notify(
                _WAIT if self._looking else "the cell has not been read yet: Ctrl-U reads it",
                severity="warning",
            )
        else:
            return not form.shows_faults() and self._fits_a_request()
        return False

    def _fits_a_request(self) -> bool:
        try:
            self._request()
        except ValueError as error:
            self.notify(str(error), title="not possible", severity="error", markup=False)
            return False
        return True

    def _given(self, name: str) -> dict[str, str]:
        """Return the parameters that a campaign gives a procedure."""
        stages = () if self._survey is None else self._survey.stages
        given = (stage.params for stage in stages if stage.procedure and stage.name == name)
        return dict(text.split("=", 1) for text in next(given, ()))

    def _request(self) -> "Start":
        """Return the request that starts what is chosen, as it is shown before it is sent."""
        from catseye.app.protocol.requests import Start

        form, cell, procedure = self.query_one(ParameterForm), self.session.cell, self._procedure
        typed = form.typed
        return Start(
            procedure=self._chosen,
            # The engine may have been started in another folder.
            cell=None if cell is None else str(cell.absolute()),
            params=[] if procedure is None else form.params(set(procedure.params)),
            search=typed.get("search", "auto"),
            speed=1.0 if self._real else float(typed.get("speed", self.session.speed)),
            job=self.session.job,
        )

    def start_text(self, request: "Start") -> str:
        """Say what would begin."""
        engine = self.session.link.engine
        procedure = None if self._survey is None else self._survey.procedure(request.procedure)
        shown = [
            f"{request.procedure} on cell {self._cell_name} ({request.cell})",
            *choice_lines(request, aims=procedure is not None and procedure.needs_aim),
            *(WALK_LINES if request.walk else ()),
            *start_rows(engine, self.rehearser.verdict(request), self.session.now_s()),
            *speed_lines(request),
            *open_lines(self._needs_of(procedure)),
        ]
        return "\n".join(shown)

    def _needs_of(self, procedure: "ProcedureEntry | None") -> tuple[Need, ...]:
        """Return what a procedure and its devices need."""
        return (*(() if procedure is None else procedure.needs), *self._of_bench)

    def wanted(self) -> "Start | None":
        """Return what would start what is chosen; None while nobody can say."""
        form = self.query_one(ParameterForm)
        known = self.session.cell is not None and self._cell_name and form.procedure == self._chosen
        if not known or form.faults:
            return None
        try:
            return self._request()
        except ValueError:
            return None

    def show_verdict(self) -> None:
        """Show what has become of a rehearsal."""
        self._show_needs()

    def show_looked(self) -> None:
        """Show how far cell and runs have been looked at."""
        self._show_needs()

    def show_fault(self, fault: str) -> None:
        """Show why nothing is known of the cell."""
        self._chosen = ""
        self.show_survey()
        self.query_one("#needed", StaticText).set_text(Content(f"✗ {fault}").stylize("$error"))

    def say(self, text: str) -> None:
        """Say beside the list what is done meanwhile."""
        self.query_one("#doing", StaticText).set_text(Content(text))
        set_subtitle(self.query_one("#list-panel"), "wait …" if text else "")
