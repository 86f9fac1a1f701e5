"""The screen Run: steps, instruction, live value, question, residuals, log; and what comes after the end."""

from collections.abc import Iterable
from functools import partial
from typing import ClassVar, Final

from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical

from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui.dialogs.override_dialog import OverrideDialog
from catseye.app.tui.dialogs.questions import MotionDialog
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.going_on import ahead_text
from catseye.app.tui.rehearsing import rehearsed
from catseye.app.tui.resolution.step_plots import StaircasePlot, StepErrorPlot
from catseye.app.tui.run_state import RunState
from catseye.app.tui.run_text import WALK, holder_text, idle_plots, instruction_text, live_plots
from catseye.app.tui.screens.ended_run import EndedRunScreen
from catseye.app.tui.session import Session
from catseye.app.tui.walk_feeder import WalkFeeder
from catseye.app.tui.widgets.live_panel import LivePanel
from catseye.app.tui.widgets.progress_line import ProgressLine
from catseye.app.tui.widgets.prompt_panel import PromptPanel
from catseye.app.tui.widgets.record_figures import RecordFigures
from catseye.app.tui.widgets.run_end import RunEnd
from catseye.app.tui.widgets.run_log import RunLog
from catseye.app.tui.widgets.run_plots import LivePlot, RunPlot
from catseye.app.tui.widgets.static_text import StaticText
from catseye.app.tui.widgets.step_list import StepList

_ROOMY_LINES: Final = 24


class RunScreen(EndedRunScreen):
    """What is under way, or how it ended."""

    SCREEN = "run"
    F8 = "move"
    AUTO_FOCUS = ""

    DEFAULT_CSS = """
    RunScreen #instruction { height: auto; max-height: 4; padding: 0 1; text-style: bold; }
    RunScreen #middle { height: 1fr; }
    RunScreen StepList { width: 2fr; min-width: 36; max-width: 46; height: 1fr; }
    RunScreen #right { width: 3fr; }
    RunScreen RunLog { height: 5; }
    RunScreen.-tall RunLog { height: 9; }
    RunScreen.-tall.asked RunLog { height: 5; }
    RunScreen.-high PromptPanel, RunScreen.-tall PromptPanel { max-height: 18; }
    RunScreen.-high #ahead, RunScreen.-tall #ahead { height: auto; text-wrap: wrap; }
    RunScreen.log #middle { display: none; }
    RunScreen.log RunLog { height: 1fr; text-wrap: wrap; }
    RunScreen.-low.asked RunLog { display: none; }
    RunScreen.-low.asked RunPlot { display: none; }
    RunScreen.-low.asked.log RunLog { display: block; }
    RunScreen.-low .second { display: none; }
    RunScreen.-low.maps .second { display: block; }
    RunScreen.-low.maps .first { display: none; }
    RunScreen.-low.asked .second { display: none; }
    RunScreen #steps-plots { display: none; }
    RunScreen.stepping #steps-plots { display: block; }
    RunScreen.stepping #pictures { display: none; }
    RunScreen LivePlot { height: 7; }
    RunScreen.unwatched LivePanel, RunScreen.unwatched LivePlot { display: none; }
    RunScreen.-low LivePlot, RunScreen.ended LivePlot { display: none; }
    RunScreen.-low.asked #pictures { display: none; }
    RunScreen.-low.picture StepList { display: none; }
    RunScreen.-low.picture LivePanel, RunScreen.-low.picture RunLog { display: none; }
    RunScreen.-low.ended LivePanel, RunScreen.-low.ended RunLog { display: none; }
    RunScreen.-low.ended.log RunLog { display: block; }
    RunScreen.-narrow StepList { display: none; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        # Keys in the footer can be clicked: this one is shown beside the question.
        Binding(
            "f8",
            "move",
            "let the arm move",
            show=False,
            id="run.move",
            tooltip="gives the answer that lets the arm move",
        ),
        Binding(
            "space",
            "walk",
            "walk",
            show=False,
            id="run.walk",
            tooltip="hold: the walk continues; let go: the arm stops. Not an enabling device",
        ),
        Binding("y", "yes", "yes", show=False, id="run.yes", tooltip="answers yes if no motion follows"),
        Binding("n", "no", "no", show=False, id="run.no", tooltip="answer no"),
        *(
            Binding(str(k), f"choose({k})", f"choice {k}", show=False, id=f"run.choice-{k}")
            for k in range(1, 10)
        ),
        Binding("a", "control", "control", id="run.control", tooltip="takes control, or gives it back"),
        Binding("minus", "override", "override", id="run.override", tooltip="lowers the speed override"),
        Binding(
            "o",
            "open_page",
            "open",
            show=False,
            id="run.open",
            tooltip="after the end: opens the page in the browser",
        ),
        Binding(
            "v",
            "view",
            "picture",
            id="run.view",
            tooltip="shows the next picture, staircase or step errors",
        ),
        Binding("l", "log", "log", id="run.log", tooltip="shows the log on the whole screen; again: back"),
        Binding(
            "f",
            "level",
            "level",
            show=False,
            id="run.level",
            tooltip="shows all of the log, warnings or errors",
        ),
        Binding(
            "t",
            "after('validate')",
            "validate",
            show=False,
            id="run.validate",
            tooltip="compares the result with what the run has measured",
        ),
        Binding("pageup", "earlier", "earlier steps", show=False, id="run.earlier"),
        Binding("pagedown", "later", "later steps", show=False, id="run.later"),
        Binding("i", "after('analyse')", "identify", show=False, id="run.identify", tooltip="after the end"),
        Binding(
            "p",
            "after('report')",
            "report",
            show=False,
            id="run.report",
            tooltip="writes a page about the run",
        ),
        Binding(
            "e",
            "after('compensate')",
            "compensate",
            show=False,
            id="run.export",
            tooltip="after the end: writes corrected commands, or shows those written",
        ),
        Binding(
            "b",
            "after('trend')",
            "trend",
            show=False,
            id="run.compare",
            tooltip="after the end: shows all results of this arm over time",
        ),
        Binding(
            "r",
            "after('resume')",
            "resume",
            show=False,
            id="run.resume",
            tooltip="continues the run where it ended",
        ),
        Binding("x", "after('clear')", "clear", show=False, id="run.clear", tooltip="clear an abort"),
        Binding(
            "escape",
            "back",
            "back",
            show=False,
            id="run.back",
            tooltip="ends a command that was started here",
        ),
    ]  # fmt: skip - a key a line

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (66, "-wide")]
        self.VERTICAL_BREAKPOINTS = [(0, "-low"), (36, "-high"), (50, "-tall")]
        self._planned_for: RunState | None = None
        self._feeder = WalkFeeder(session.link, session.now_s, self._not_fed)

    def body(self) -> ComposeResult:
        """Put the parts together."""
        yield ProgressLine()
        yield StaticText(id="instruction")
        with Horizontal(id="middle"):
            yield StepList()
            with Vertical(id="right"):
                yield LivePanel()
                with Vertical(id="pictures"):
                    yield LivePlot()
                    yield RecordFigures(self.session.painter, self.session.now_s, id="record-figures")
                with Vertical(id="steps-plots"):
                    yield StaircasePlot()
                    yield StepErrorPlot()
        yield PromptPanel(self.session.now_s)
        yield RunEnd()
        yield RunLog()

    def commands(self) -> Iterable[SystemCommand]:
        """Return what this screen can do."""
        yield SystemCommand("Answer: let the arm move", "F8 confirms it", self.action_ask_to_move)
        yield SystemCommand("Walk on", "hold Space here; one press moves nothing", self.action_walk)
        yield SystemCommand("Answer: yes", "if no motion follows", self.action_yes)
        yield SystemCommand("Answer: no", "to a question of yes or no", self.action_no)
        for number in range(1, 10):
            yield SystemCommand(
                f"Answer: choice {number}", "of the open question", partial(self.action_choose, number)
            )
        yield SystemCommand("Take or give back control", "of the engine", self.action_control)
        yield SystemCommand("Lower the speed override", "before the next motion", self.action_override)
        yield SystemCommand("After the run: open the page", "in the browser", self.action_open_page)
        yield SystemCommand("The next picture", "if there is no room for all", self.action_view)
        yield SystemCommand("Log on the whole screen", "and back", self.action_log)
        yield SystemCommand("Level of the log", "all, warnings, errors", self.action_level)
        yield SystemCommand("Earlier steps", "move the list", self.action_earlier)
        yield SystemCommand("Later steps", "move the list", self.action_later)
        yield SystemCommand("End the command", "that was begun here", self.action_back)
        for kind in ("analyse", "validate", "report", "compensate", "trend", "resume", "clear"):
            yield SystemCommand(f"After the run: {kind}", "if it applies", partial(self.action_after, kind))

    def on_mount(self) -> None:
        """A terminal that nobody looks at walks nothing."""
        self.watch(self.app, "app_focus", self._focus_changed, init=False)

    def on_screen_suspend(self) -> None:
        """Another screen or a dialog covers this one: a walk stops."""
        self._feeder.let_go()

    def on_unmount(self) -> None:
        """A walk stops."""
        self._feeder.let_go()

    def on_screen_resume(self) -> None:
        """Show what has happened meanwhile; the open question has the keyboard's focus."""
        super().on_screen_resume()
        self._panel.come_up()

    def show_state(self, engine: EngineState, now_s: float) -> None:
        """Show the run."""
        run = engine.run
        self._plan_of(run)
        asked = run is not None and run.prompt is not None
        ended = run is not None and not run.active
        self.set_class(asked, "asked")
        if asked:
            self.remove_class("picture")
        self.set_class(ended, "ended")
        # Some procedures show no live value: their pictures have its room.
        unwatched = run is not None and not asked and run.steps_done > 0 and run.watched is None
        self.set_class(unwatched, "unwatched")
        skipped = engine.missed["points and steps"]
        # Until its record is read, a run is taken for one that began here.
        speed = self.session.speed if run is None or run.speed is None else run.speed
        pace = speed if engine.simulated else 1.0
        self.query_one(ProgressLine).show(run, skipped, now_s, pace)
        instruction = self.query_one("#instruction", StaticText)
        instruction.set_text(instruction_text(engine))
        instruction.display = not ended
        self.query_one(StepList).show(run)
        stepping = (idle_plots(engine) if run is None else live_plots(run.procedure)) == "steps"
        self.set_class(stepping, "stepping")
        if not stepping:
            self.query_one(RecordFigures).show(run, self.session.root)
        for plot in self.query(RunPlot):
            plot.show(run)
        self.query_one(RunLog).show(run, holder_text(engine))
        self.show_end(engine)
        prompt, at_s = (None, 0.0) if run is None else (run.prompt, run.prompt_at_s)
        note = (
            ""
            if engine.in_control or engine.control is None
            else f"{engine.control.text} answers; a takes control"
        )
        # The keys that answer are in sight on the smallest screen, too.
        roomy = self.size.height >= _ROOMY_LINES
        ahead = ahead_text(engine, run, now_s) if run is not None and roomy else ""
        self._panel.show(prompt, at_s, speed, note, engine.reflectors, ahead)
        self.query_one(LivePanel).show(run, now_s, "F8" if self._panel.agreement else "")

    def action_move(self) -> None:
        """Agree to the motion of the open question."""
        self._panel.move()

    def action_ask_to_move(self) -> None:
        """Show the motion of the open question; F8 confirms it there too. From the palette Enter leads here."""
        panel = self._panel
        asked, text, engine = panel.asked, panel.motion, self.session.link.engine
        if not text:
            self.notify("no motion waits for an answer", severity="warning")
            return

        def changed() -> str:
            still = engine.connected and panel.asked is asked and self._open_question(engine) is asked
            return "" if still else "that question is not open any more"

        def confirmed(move: bool | None) -> None:
            if move and asked is not None and panel.asked is asked:
                self.on_prompt_panel_answered(PromptPanel.Answered(asked.id, panel.agreement))

        self.app.push_screen(MotionDialog("The arm moves", text, changed), confirmed)

    def action_walk(self) -> None:
        """Keep a walk going for another moment; the key has to repeat."""
        engine = self.session.link.engine
        run = engine.run
        if run is not None and run.active and run.procedure == WALK and engine.in_control:
            self._feeder.press()

    def action_yes(self) -> None:
        """Answer yes."""
        self._panel.yes()

    def action_no(self) -> None:
        """Answer no."""
        self._panel.no()

    def action_choose(self, number: int) -> None:
        """Choose an answer by its number."""
        self._panel.choose(number)

    def action_control(self) -> None:
        """Take control, or give it back."""
        if self.session.link.engine.in_control:
            self.catseye.action_release()
        else:
            self.catseye.action_take_control()

    def action_override(self) -> None:
        """Ask for a lower override."""
        robot = self.session.link.engine.robot
        self.app.push_screen(OverrideDialog(None if robot is None else robot.override_percent), self._lower)

    def action_open_page(self) -> None:
        """Show the page that was written of the run."""
        if not self.open_written():
            self.notify(
                "no page about this run was written yet: p writes one after its end", severity="warning"
            )

    def action_view(self) -> None:
        """Show the next picture, on a low screen by itself; the other plot of a series of steps."""
        pictures = self.query_one(RecordFigures)
        if self.has_class("stepping"):
            self.toggle_class("maps")
        elif not self.has_class("-low"):
            pictures.turn()
        elif not self.has_class("picture"):
            self.set_class(not self.has_class("asked"), "picture")
        else:
            self.set_class(not pictures.at_the_last, "picture")
            pictures.turn()
        self.call_after_refresh(self.show_now)

    def action_log(self) -> None:
        """Show the log on the whole screen, or not."""
        self.toggle_class("log")
        self.call_after_refresh(self.show_now)

    def action_level(self) -> None:
        """Show fewer levels of the log, or all again."""
        self.query_one(RunLog).next_level()
        self.show_now()

    def action_earlier(self) -> None:
        """Show earlier steps, or more above of a text that has no room as a whole."""
        self._turn(-1)

    def action_later(self) -> None:
        """Show later steps, or more below of a text that has no room as a whole."""
        self._turn(1)

    def on_prompt_panel_answered(self, event: PromptPanel.Answered) -> None:
        """Give the answer to the engine."""
        self.run_worker(
            self._answer(event.prompt, event.text), group="answer", exclusive=True, exit_on_error=False
        )

    def _not_fed(self, text: str) -> None:
        self.notify(text, title="the walk was not continued", severity="warning", markup=False)

    def _focus_changed(self, focus: bool) -> None:
        if not focus:
            self._feeder.let_go()

    @property
    def _panel(self) -> PromptPanel:
        return self.query_one(PromptPanel)

    def _turn(self, pages: int) -> None:
        for each in self.query("PromptPanel.open #asked, RunEnd.open #how"):
            if each.max_scroll_y:
                each.scroll_relative(y=pages * each.size.height, animate=False)
                return
        steps = self.query_one(StepList)
        steps.move(pages * max(steps.size.height - 1, 1), self.session.link.engine.run)
        self.show_now()

    async def _answer(self, prompt: str, text: str) -> None:
        from catseye.app.protocol.message import MessageError
        from catseye.app.protocol.requests import request_of

        try:
            # What is typed may be longer than an answer is.
            reply = request_of({"op": "answer", "prompt": prompt, "text": text})
            await self.session.take_free_control()
            await self.session.link.request(reply)
        except (MessageError, RefusedError, ServiceError) as error:
            self._panel.refuse(prompt, str(error))

    def _lower(self, percent: float | None) -> None:
        if percent is not None:
            from catseye.app.protocol.requests import Override

            done = f"override at most {percent:g} % from the next motion on"
            self.catseye.order(
                Override(percent=percent), "The override is not lowered", control=True, done=done
            )

    def _plan_of(self, run: RunState | None) -> None:
        """Rehearse the run that is shown, once, to know the steps to come."""
        before = self._planned_for
        if run is None or run is before:
            return
        if before is not None and run.name == before.name:
            run.take_rehearsal(run.rehearsal or before.rehearsal)
        known = self.session.begun
        if (
            run.rehearsal is None
            and known is not None
            and run.seen_begin
            and known.procedure == run.procedure
        ):
            run.take_rehearsal(known)
            self.session.begun = None
        # The record says what was chosen for it, a moment after its beginning.
        if run.recorded or not run.active:
            self._planned_for = run
        if run.active and run.command and run.rehearsal is None:
            self.run_worker(self._rehearse(run), group="plan", exclusive=True, exit_on_error=False)

    async def _rehearse(self, run: RunState) -> None:
        run.take_rehearsal((await rehearsed(self.session.work, *run.command)).rehearsal)
