"""The screen Jog: joints and beam by hand."""

from collections.abc import Callable, Iterable
from functools import partial
from typing import ClassVar, Final

from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Horizontal, Vertical, VerticalScroll
from textual.widgets import Input

from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui.bench_view import BenchView
from catseye.app.tui.dialogs.questions import ConfirmDialog, MotionDialog
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.jog_client import JogClient, Step, Way
from catseye.app.tui.jog_motion import arm_changed, jog_begin_lines, jog_motion_lines, step_target
from catseye.app.tui.jog_text import (
    STEPS,
    STEPS_ONLY,
    Choices,
    can_hold,
    cap_percent,
    entry_lines,
    fresh_joints,
    jog_lines,
    jog_reason,
    range_lines,
)
from catseye.app.tui.scara.jog_keys import MOVES, POINT, POINT_COMMAND
from catseye.app.tui.screens.base import MainScreen
from catseye.app.tui.serial.jog_keys import CHOOSE, MOVE
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.beam_panel import BeamPanel
from catseye.app.tui.widgets.static_text import StaticText, lines

_SIGNS: Final = {1: "plus", -1: "minus"}

_SCARAS: Final = frozenset({"move", "aim", "point"})
"""Actions for a SCARA with a beam; `_ANY_ARMS` take the same keys on every other arm."""

_ANY_ARMS: Final = frozenset({"choose_axis", "move_axis"})

_WAYS: Final[tuple[tuple[Way, str], ...]] = ((1, "+"), (-1, "−"))


class JogScreen(MainScreen):
    """Moves the arm by keys, after F8. Leaving the screen ends it; so does Esc."""

    SCREEN = "jog"
    F8 = "begin"
    AUTO_FOCUS = ""

    DEFAULT_CSS = """
    JogScreen #jog { height: 1fr; }
    JogScreen #keys { width: 46; height: 1fr; scrollbar-size-vertical: 1; }
    JogScreen #text { height: auto; }
    JogScreen #right { width: 1fr; }
    JogScreen #plan { height: 1.5fr; }
    JogScreen.-low #plan { display: none; }
    JogScreen.-low.plan #plan { display: block; }
    JogScreen.-low.plan BeamPanel, JogScreen.beamless BeamPanel { display: none; }
    JogScreen.-low.beamless #plan { display: block; }
    JogScreen.-narrow #jog { layout: vertical; }
    JogScreen.-narrow #keys { width: 1fr; }
    JogScreen.-narrow #right { height: 3; }
    JogScreen.-narrow.-high #right { height: 14; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f8", "begin", "jog", id="jog.begin", tooltip="drives on; the keys move the arm"),
        Binding("escape", "end", "end the jog", id="jog.end", tooltip="the arm stops, drives as before"),
        Binding(
            "m",
            "mode",
            "steps / hold",
            show=False,
            id="jog.mode",
            tooltip="moves in steps, or as long as a key is held",
        ),
        Binding("n", "aim", "aim", show=False, id="jog.aim", tooltip="next reflector; none after the last"),
        Binding(
            "p",
            "point",
            "point",
            show=False,
            id="jog.point",
            tooltip=POINT,
        ),
        Binding(
            "equals_sign",
            "override",
            "override",
            show=False,
            key_display="=",
            id="jog.override",
            tooltip="restores the override from before a jog or walk; y there confirms",
        ),
        Binding("v", "view", "view", id="jog.view", tooltip="the beam, or the arm to scale"),
        Binding(
            "exclamation_mark",
            "reset_alarm",
            "reset alarm",
            show=False,
            key_display="!",
            id="jog.reset-alarm",
            tooltip="shows the controller's alarm; y there resets it",
        ),
        Binding(
            "comma", "window", "10/30/60 s", show=False, id="jog.window", tooltip="length of the strip chart"
        ),
        Binding(
            "plus,pageup",
            "faster",
            "faster",
            show=False,
            id="jog.faster",
            tooltip="before the jog: sets the speed",
        ),
        Binding(
            "minus,pagedown",
            "slower",
            "slower",
            show=False,
            id="jog.slower",
            tooltip="before the jog: sets the speed",
        ),
        *(
            Binding(
                str(place + 1), f"size({place})", f"step {place + 1}", show=False, id=f"jog.step-{place + 1}"
            )
            for place in range(len(STEPS))
        ),
        *(
            Binding(
                keys,
                f"move('{joint}', {way})",
                text,
                show=False,
                id=f"jog.{joint}-{_SIGNS[way]}",
                tooltip=text,
            )
            for keys, joint, way, text in MOVES
        ),
        *(
            Binding(keys, f"{action}({way})", text, show=False, id=f"jog.{name}", tooltip=text)
            for action, table in (("choose_axis", CHOOSE), ("move_axis", MOVE))
            for keys, way, name, text in table
        ),
    ]

    def __init__(self, session: Session) -> None:
        super().__init__(session)
        self.HORIZONTAL_BREAKPOINTS = [(0, "-narrow"), (76, "-wide")]
        self.VERTICAL_BREAKPOINTS = [(0, "-low"), (30, "-high")]
        self.choices = Choices()
        self.jog_client = JogClient(session.link, session.now_s, self._say)
        self._beginning = False
        self._jogged = False

    def body(self) -> ComposeResult:
        """Keys at the left, what the beam does at the right."""
        with Horizontal(id="jog"):
            with VerticalScroll(id="keys", classes="panel", can_focus=False) as panel:
                panel.border_title = "Jog"
                yield StaticText(id="text")
                typed = Input(placeholder="type the cell's name, then F8", id="typed")
                typed.display = False
                yield typed
            with Vertical(id="right"):
                yield BeamPanel()
                yield BenchView(id="plan", classes="panel")

    def on_mount(self) -> None:
        """A terminal that nobody looks at moves nothing."""
        self.watch(self.app, "app_focus", self._focus_changed, init=False)

    def on_screen_suspend(self) -> None:
        """Another screen or a dialog covers this one: the arm stops; another screen ends the jog."""
        self.jog_client.let_go()
        if self.app.current_mode != self.SCREEN:
            self.action_end()

    def on_unmount(self) -> None:
        """The arm stops."""
        self.jog_client.let_go()

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Return whether a key means this action: some keys mean one thing on a SCARA and another on other arms."""
        scara = self.session.link.engine.layout is not None
        return action not in (_ANY_ARMS if scara else _SCARAS) and super().check_action(action, parameters)

    def commands(self) -> Iterable[SystemCommand]:
        """Return what this screen can do; what moves asks for F8 first, for the palette is left by Enter."""
        yield SystemCommand("Begin to jog", "drives on; asks first", self._ask_to_begin)
        yield SystemCommand("End the jog", "the arm stops, drives as before", self.action_end)
        yield SystemCommand("Steps or hold", "how keys move the arm", self.action_mode)
        yield SystemCommand("Faster jog", "before it begins", self.action_faster)
        yield SystemCommand("Slower jog", "before it begins", self.action_slower)
        yield SystemCommand("Beam or arm", "if there is room for one only", self.action_view)
        yield SystemCommand("Override from before the jog", "restore it; asks first", self.action_override)
        yield SystemCommand(
            "Reset the alarm", "of the controller; shows its text first", self.action_reset_alarm
        )
        yield SystemCommand("Length of the strip chart", "10, 30 or 60 s", self.action_window)
        for place, size in enumerate(STEPS):
            yield SystemCommand(
                f"Steps of {size:g} deg", "mm for linear motion", partial(self.action_size, place)
            )
        yield from self._scara_commands() if self.session.link.engine.layout else self._axis_commands()

    def _scara_commands(self) -> Iterable[SystemCommand]:
        yield SystemCommand("Next aim", "reflector that the beam is kept on", self.action_aim)
        yield SystemCommand("Point at the aim", POINT_COMMAND, self.action_point)
        for _, joint, way, text in MOVES:
            yield SystemCommand(
                f"One step: {text}",
                "asks first",
                partial(self._ask_to_step, joint, way, text, "mm" if joint == "beam" else "deg"),
            )

    def _axis_commands(self) -> Iterable[SystemCommand]:
        for _, way, _, text in CHOOSE:
            yield SystemCommand(
                f"Choose the {text}", "that the keys move", partial(self.action_choose_axis, way)
            )
        for axis in () if (bench := self.session.link.engine.bench) is None else bench.axes:
            for way, sign in _WAYS:
                yield SystemCommand(
                    f"One step: {axis.name} {sign}",
                    "asks first",
                    partial(self._ask_to_step, axis.name.lower(), way, f"{axis.name} {sign}", axis.unit),
                )

    def show_state(self, engine: EngineState, now_s: float) -> None:
        """Show what the keys do, or what has to be known before they do anything."""
        jogs = self._jogs
        if self._jogged and not jogs:
            self.jog_client.let_go()
            self.choices.said = jog_reason(engine) or engine.trouble or "the jog is over"
        self._jogged = jogs
        said = self.choices.said
        shown = jog_lines(engine, self.choices, now_s) if jogs else entry_lines(engine, self.choices, said)
        # Of other arms than a SCARA the axes that are jogged have these bars beside their values.
        if not self.has_class("-low") and not (jogs and engine.layout is None):
            shown += range_lines(engine, now_s)
        self.set_class(engine.bench is not None and engine.bench.is_without_beam, "beamless")
        self.query_one("#text", StaticText).set_text(lines(*shown))
        self._show_typed(needed=not jogs and engine.bench is not None and not engine.bench_simulated)
        self.query_one(BeamPanel).show(engine, now_s)
        self.query_one(BenchView).show(engine, now_s)

    def action_begin(self) -> None:
        """Say what the beginning of a jog does; F8 there begins it, held down or pressed twice it does not."""
        self._ask_to_begin(self.session.now_s)

    def _begin_now(self, percent: float) -> None:
        self._beginning = True
        typed = self.query_one("#typed", Input).value.strip()
        self.run_worker(self._begin(percent, typed or None), group="jog", exit_on_error=False)

    def action_end(self) -> None:
        """Stop the arm and end the jog."""
        self.jog_client.let_go()
        if self._jogs or self._beginning:
            from catseye.app.protocol.requests import JogMode

            self._beginning = False
            self.catseye.order(
                JogMode(on=False), "The jog is not ended: USE THE EMERGENCY STOP if the arm moves"
            )

    def action_move(self, joint: str, way: Way) -> None:
        """Move by a step, or as long as the key repeats; the beam moves by steps only."""
        if not self._jogs:
            return
        if self._holds and joint != "beam":
            self.jog_client.press(joint, way)
        elif joint == "beam" and self.choices.aim is None:
            self._say("steps of the beam are measured at a reflector: choose one with n")
        else:
            self._take(Step(joint, way * self.choices.by, self.choices.aim))

    def action_choose_axis(self, way: Way) -> None:
        """Choose the axis that keys move."""
        self.jog_client.let_go()
        bench = self.session.link.engine.bench
        self.choices.next_axis(way, 0 if bench is None else len(bench.axes))
        self.show_now()

    def action_move_axis(self, way: Way) -> None:
        """Move the chosen axis by a step, or as long as the key repeats."""
        bench = self.session.link.engine.bench
        if bench is not None and self.choices.axis < len(bench.axes):
            self.action_move(bench.axes[self.choices.axis].name.lower(), way)

    def action_mode(self) -> None:
        """Change between steps and holding."""
        self.jog_client.let_go()
        if not can_hold(self.session.link.engine):
            self._say(STEPS_ONLY)
            return
        self.choices.holds = not self.choices.holds
        self.show_now()

    def action_size(self, place: int) -> None:
        """Choose the size of a step."""
        self.choices.step = place
        self.show_now()

    def action_aim(self) -> None:
        """Choose the next reflector."""
        self.choices.next_aim([each.name for each in self.session.link.engine.reflectors])
        self.show_now()

    def action_point(self) -> None:
        """Turn the beam until it points at the aim, once F8 confirms it."""
        if not self._jogs or self.jog_client.busy:
            return
        engine, aim = self.session.link.engine, self.choices.aim
        joints = fresh_joints(engine, self.session.now_s())
        if aim is None:
            self._say("there is nothing to point at: choose a reflector with n")
            return
        if joints is None or engine.layout is None:
            self._say("the last reading of the joints is too old")
            return
        from catseye.app.tui.scara.pointing import turn_towards

        turn = turn_towards(engine.layout, joints, aim)
        if isinstance(turn, str):
            self._say(turn)
            return
        target = (*joints[:3], joints[3] + sum(step.by for step in turn.steps))
        self._ask(
            f"Point the beam at {aim}",
            jog_motion_lines(engine, turn.text, target, self.session.now_s()),
            partial(self._take, *turn.steps),
        )

    def action_faster(self) -> None:
        """Choose a higher speed for the next jog."""
        if not self._jogs:
            self.choices.faster(cap_percent(self.session.link.engine))
            self.show_now()

    def action_slower(self) -> None:
        """Choose a lower speed for the next jog."""
        if not self._jogs:
            self.choices.slower()
            self.show_now()

    def action_override(self) -> None:
        """Ask whether the speed override that stood before a jog is to be set again; y there does it."""
        left, jogs = self.session.link.engine.override_left, self._jogs
        if left is None or jogs:
            self._say(
                "the jog goes on: end it first"
                if jogs
                else "no jog or walk has lowered the override; see the controller"
            )
            return
        percent = left.before_percent

        def answered(agreed: bool | None) -> None:
            if agreed:
                from catseye.app.protocol.requests import RestoreOverride

                done = f"the speed override is {percent:g} % again"
                self.catseye.order(
                    RestoreOverride(percent=percent), "The override stays as it is", control=True, done=done
                )

        text = (
            f"The jog or walk has left it at {left.left_percent:g} %; {percent:g} % is what it was before, or the "
            "cell's cap. This moves nothing, but the next motion will be faster. If somebody has changed the "
            "override meanwhile, it stays as it is."
        )
        title = f"Set the speed override to {percent:g} % again?"
        self.app.push_screen(ConfirmDialog(title, text, "set it", "leave it"), answered)

    def action_view(self) -> None:
        """Show the picture of the arm in place of the beam, or the beam again."""
        self.toggle_class("plan")
        self.call_after_refresh(self.show_now)

    def action_window(self) -> None:
        """Show another length of time in the strip."""
        self.query_one(BeamPanel).next_window()
        self.show_now()

    @property
    def _jogs(self) -> bool:
        """The arm is this client's to move."""
        engine = self.session.link.engine
        return engine.jogging and engine.in_control

    @property
    def _holds(self) -> bool:
        """Keys move a joint as long as they are held."""
        return self.choices.holds and can_hold(self.session.link.engine)

    def _take(self, *steps: Step) -> None:
        if self._jogs and self.jog_client.step(*steps):
            self._say("")

    def _ask(self, title: str, shown: list[str], then: Callable[[], None]) -> None:
        """Say what will move, and have it done when F8 confirms it, if the arm stands as it did then."""
        changed = arm_changed(self.session.link.engine, self.session.now_s)
        dialog = MotionDialog(title, "\n".join(shown), changed)
        self.app.push_screen(dialog, lambda confirmed: then() if confirmed else None)

    def _ask_to_begin(self, now_s: Callable[[], float] | None = None) -> None:
        engine = self.session.link.engine
        if why := self._why_not_begun():
            self.notify(why, severity="warning")
            return
        percent = min(float(self.choices.percent), cap_percent(engine))
        # Nothing moves yet: wherever the arm stands, what is said holds.
        dialog = MotionDialog("Jog", "\n".join(jog_begin_lines(engine, percent)), self._why_not_begun, now_s)
        self.app.push_screen(dialog, lambda confirmed: self._begin_now(percent) if confirmed else None)

    def _why_not_begun(self) -> str:
        """Return why no jog begins; empty where one may be asked for."""
        engine = self.session.link.engine
        if engine.running:
            return "a run is under way: jog when it has ended"
        return "the arm is jogged already" if self._beginning or engine.jogging else ""

    def _ask_to_step(self, joint: str, way: Way, text: str, unit: str) -> None:
        if self._jogs and (joint != "beam" or self.choices.aim is not None):
            engine, now_s = self.session.link.engine, self.session.now_s()
            step = Step(joint, way * self.choices.by, self.choices.aim)
            shown = jog_motion_lines(
                engine, f"{text} by {self.choices.by:g} {unit}", step_target(engine, step, now_s), now_s
            )
            self._ask("One step", shown, partial(self._take, step))

    async def _begin(self, percent: float, arm: str | None) -> None:
        from catseye.app.protocol.message import MessageError
        from catseye.app.protocol.requests import request_of

        self._say("switching the drives on…")
        try:
            # Nobody has looked at what is typed as the arm's name.
            begin = request_of({"op": "jog", "on": True, "percent": percent, "arm": arm})
            await self.session.take_free_control()
            await self.session.link.request(begin)
            self._say("")
        except (MessageError, RefusedError, ServiceError) as error:
            self._say("")
            if not self._beginning:
                # It was ended before it had begun.
                return
            self.catseye.show_error("The arm cannot be moved by hand", str(error))
        finally:
            self._beginning = False

    def _show_typed(self, *, needed: bool) -> None:
        """Ask for the cell's name where the arm is real; a name is typed anew for each jog."""
        typed = self.query_one("#typed", Input)
        if typed.display == needed:
            return
        typed.display = needed
        typed.value = ""
        self.set_focus(typed if needed else None)

    def _focus_changed(self, focus: bool) -> None:
        if not focus:
            self.jog_client.let_go()

    def _say(self, text: str) -> None:
        self.choices.said = text
        if self.is_mounted and self.is_current:
            self.show_now()
