"""The program: screens, keys that work everywhere, and the way out."""

import asyncio
from collections.abc import Callable, Coroutine, Iterable
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, Final

from textual.app import App, SystemCommand
from textual.binding import Binding, BindingType
from textual.notifications import SeverityLevel
from textual.screen import Screen

from catseye.app.tui.cell_change import look_at_cell
from catseye.app.tui.dialogs.confirm_dialog import ConfirmDialog
from catseye.app.tui.dialogs.error_dialog import ErrorDialog
from catseye.app.tui.dialogs.motion_dialog import MotionDialog
from catseye.app.tui.dialogs.quit_dialog import Choice, QuitDialog
from catseye.app.tui.faults import fault_text
from catseye.app.tui.main_screens import MAIN_SCREENS, make_screen
from catseye.app.tui.screens.base import MainScreen
from catseye.app.tui.session import Session
from catseye.app.tui.start_checks import check_settings
from catseye.app.tui.stopping import StopOp
from catseye.app.tui.themes import HIGH_CONTRAST, THEMES

if TYPE_CHECKING:
    from catseye.app.tui.palette import Actions

_REFRESH_S: Final = 0.2
"""Screens are painted anew at most so often."""

_LOOK_S: Final = 2.0
"""Keys and cell file are looked at so long after the first screen: what that imports would delay it."""

_STANDSTILL_S: Final = 15.0


def _actions() -> "type[Actions]":
    # The first screen is painted before this is imported.
    from catseye.app.tui.palette import Actions

    return Actions


class CatseyeApp(App[int]):
    """The terminal user interface.

    Args:
        session: link, work and places.
        keymap: a user's keys by the name of what they do.
        place: screen that is shown first.
        trouble: title and text of what went wrong before; told at once.
    """

    TITLE = "catseye"
    CSS_PATH = "styles/app.tcss"
    ENABLE_COMMAND_PALETTE = True
    COMMANDS: ClassVar[set[Any]] = {_actions}

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f12", "stop", "STOP", priority=True, id="run.stop", tooltip="stop the arm now"),
        Binding("ctrl+c", "ladder", "hold, stop, abort", show=False, priority=True, id="run.ladder"),
        Binding("h", "hold", "hold", show=False, id="run.hold", tooltip="hold at the next checkpoint"),
        Binding("g", "go_on", "go on", show=False, id="run.go-on", tooltip="let a held run go on"),
        Binding("ctrl+q", "quit", "quit", priority=True, id="app.quit"),
        Binding("f1", "help", "help", id="app.help"),
        *(
            Binding(
                place.key, f"go('{name}')", place.title, show=False, id=f"go.{name}", tooltip=place.tooltip
            )
            for name, place in MAIN_SCREENS.items()
        ),
    ]

    def __init__(
        self,
        session: Session,
        keymap: dict[str, str] | None = None,
        place: str = "bench",
        trouble: tuple[str, str] | None = None,
    ) -> None:
        # The screen that is shown first, in place of an empty one that is made, drawn and left before it.
        self.DEFAULT_MODE = place  # type: ignore[misc]  # is read by the instance
        super().__init__()
        self.session = session
        self._own_keys = dict(keymap or {})
        self._trouble = trouble
        self._known_facts: dict[str, Any] = {}
        self._had_control = False
        self._ended = asyncio.Event()
        self._faults: set[str] = set()
        self._orders: set[asyncio.Task[None]] = set()
        self._unmounted = False
        self._own_loop: asyncio.AbstractEventLoop | None = None
        for theme in THEMES:
            self.register_theme(theme)
        self.theme = "catseye-dark"
        for name in MAIN_SCREENS:
            self.add_mode(name, partial(make_screen, name, session))
        if keymap:
            self.set_keymap(keymap)

    async def on_mount(self) -> None:
        """Look for the engine, now that the first screen is shown."""
        self._own_loop = asyncio.get_running_loop()
        self.keep(self.session.link.serve(self._note_change))
        self.set_interval(_REFRESH_S, self._show_changes)
        if self._trouble is not None:
            self.show_error(*self._trouble)
        self.set_timer(_LOOK_S, self._look_at_settings)

    def _look_at_settings(self) -> None:
        # The time may be over while the program ends.
        if not self._unmounted:
            self.keep(check_settings(self, self._own_keys))

    async def on_unmount(self) -> None:
        """Let the engine go; without a word of release it does what `on_client_lost` says."""
        self._unmounted = True
        tasks = list(self._orders)
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    def watch_theme(self, theme: str) -> None:
        """Draw lines as strong as text where contrast is asked for."""
        self.set_class(theme == HIGH_CONTRAST.name, "-contrast")

    def get_system_commands(self, screen: Screen[Any]) -> Iterable[SystemCommand]:
        """Put every action of the program and of the screen into the palette; what changes nothing comes first."""
        for name, place in MAIN_SCREENS.items():
            yield SystemCommand(f"Go to {place.title}", place.tooltip, partial(self.action_go, name))
        if isinstance(screen, MainScreen):
            yield from screen.commands()
        yield SystemCommand("Hold the run", "at the next checkpoint", self.action_hold)
        yield SystemCommand("Let the run go on", "after a hold; asks first", self.action_ask_to_go_on)
        yield SystemCommand("STOP", "the arm stops now; the run can be resumed", self.action_stop)
        yield SystemCommand("Abort the run", "stop, and leave only by clearing", self.action_abort)
        yield SystemCommand("Clear an abort", "after a look at the bench", self.action_clear)
        yield SystemCommand("Take control", "from whoever has it", self.action_take_control)
        yield SystemCommand("Give control back", "the run goes on as it is", self.action_release)
        yield from super().get_system_commands(screen)

    def action_go(self, name: str) -> None:
        """Show a screen."""
        self.switch_mode(name)

    def action_help(self) -> None:
        """Show the keys of what is on the screen, or hide them."""
        if self.screen.query("HelpPanel"):
            self.action_hide_help_panel()
        else:
            self.action_show_help_panel()

    def action_hold(self) -> None:
        """Hold the run at its next checkpoint."""
        self.order("hold", "The run cannot be held")

    def action_go_on(self) -> None:
        """Let a held run go on."""
        self.order("unhold", "The run does not go on", control=True)

    def action_ask_to_go_on(self) -> None:
        """Let a held run go on once F8 confirms it: the palette is left by Enter, and a click is soon made."""
        run = self.session.link.engine.run
        if run is None or not self.session.link.engine.running:
            self.notify("no run is held")
            return
        robot = (self.session.link.engine.bench or {}).get("robot") or {}
        percent = robot.get("override_percent")
        speed = "" if percent is None else f" at {percent:g} % of the programmed speed"
        text = f"{run.name} goes on where it was held: the arm moves{speed}."
        self.push_screen(
            MotionDialog("Let the run go on", text), lambda agreed: self.action_go_on() if agreed else None
        )

    def action_stop(self) -> None:
        """Stop the arm now."""
        self.keep(self._stop("stop"))

    def action_abort(self) -> None:
        """Abort the run."""
        self.keep(self._stop("abort"))

    def action_clear(self) -> None:
        """Clear an abort."""
        self.order("clear", "The abort is not cleared", control=True, done="cleared")

    def action_take_control(self) -> None:
        """Take control; from somebody else only after a question, and by force: whoever has it is told."""
        engine = self.session.link.engine
        if engine.control is None or engine.in_control:
            self._take_control(force=False)
            return
        holder = f"{engine.control.get('who')} ({engine.control.get('client')})"
        text = f"{holder} answers questions and lets the run go on until now, and is told that you do from now on."

        def answered(agreed: bool | None) -> None:
            if agreed:
                self._take_control(force=True)

        self.push_screen(ConfirmDialog(f"Take control from {holder}?", text, "take it", "leave it"), answered)

    def _take_control(self, *, force: bool) -> None:
        self.order("control", "Control was not taken", done="control taken", take=True, force=force)

    def action_release(self) -> None:
        """Give control back."""
        self.order("release", "Control was not given back", done="control given back")

    def action_ladder(self) -> None:
        """Hold, then stop, then abort, as Ctrl-C does under `catseye run`."""
        engine = self.session.link.engine
        if engine.jogging or engine.silent_since_s is not None or engine.run_out_of_sight:
            self.action_stop()
        elif not engine.running:
            self.notify("Ctrl-Q quits; F12 stops", title="nothing runs")
        elif engine.state in {"HOLDING", "HELD", "SUSPENDED", "SUSPENDING", "UNSUSPENDING", "STARTING"}:
            self.action_stop()
        elif engine.state in {"STOPPING", "ABORTING"}:
            self.action_abort()
        else:
            self.action_hold()

    async def action_quit(self) -> None:
        """Quit; while a run is under way ask what becomes of it, and before a command is ended that works."""
        engine = self.session.link.engine
        if engine.running and engine.run is not None:
            self.push_screen(QuitDialog(engine.run.name), self._quit_as_chosen)
        elif self.session.under_way:
            text = (
                f"{', '.join(self.session.under_way)}: it ends with this program; what it has done is lost."
            )
            self.push_screen(
                ConfirmDialog("Work is under way", text, "quit", "stay here"), self._quit_if_agreed
            )
        else:
            self._quit_if_agreed(True)

    def _quit_if_agreed(self, agreed: bool | None) -> None:
        jogging = self.session.link.engine.jogging
        if agreed:
            self.keep(self._stop_and_leave() if jogging else self._leave(end_engine=True))

    def order(
        self,
        op: str,
        failure: str,
        *,
        control: bool = False,
        done: str = "",
        then: Callable[[dict[str, Any]], None] | None = None,
        **fields: Any,
    ) -> asyncio.Task[None]:
        """Have the engine do something; a refusal is shown with its remedy. Returns at once what ends with it.

        Args:
            op: request.
            failure: title of the error when it is not done.
            control: take control first when nobody has it.
            done: said when it is done.
            then: is given the answer.
            fields: of the request.
        """
        return self.keep(self._order(op, failure, control=control, done=done, then=then, **fields))

    def notify(
        self,
        message: str,
        *,
        title: str = "",
        severity: SeverityLevel = "information",
        timeout: float | None = None,
        markup: bool = False,
    ) -> None:
        """Show a message for some time; none holds markup, and names of people and files may look like it."""
        del markup
        super().notify(message, title=title, severity=severity, timeout=timeout, markup=False)

    def show_error(self, title: str, text: str) -> None:
        """Show an error that can be copied; the same one is not shown twice over."""
        if isinstance(self.screen, ErrorDialog) and self.screen.shown == (title, text):
            return
        self.push_screen(ErrorDialog(title, text))

    def show_fault(self, error: BaseException) -> None:
        """Tell of a fault of this program, each once; everything else goes on."""
        if self.is_running and repr(error) not in self._faults:
            self._faults.add(repr(error))
            self.show_error("A fault of this program", fault_text(error))

    def keep(self, action: Coroutine[Any, Any, None]) -> asyncio.Task[None]:
        """Have something go on until it is done or the program ends, whatever screen is shown."""
        task = asyncio.get_running_loop().create_task(action)
        self._orders.add(task)
        task.add_done_callback(self._kept)
        return task

    def _kept(self, task: asyncio.Task[None]) -> None:
        self._orders.discard(task)
        if not task.cancelled() and (error := task.exception()) is not None:
            self.show_fault(error)

    async def _stop(self, op: StopOp) -> None:
        from catseye.app.service.errors import RefusedError, ServiceError

        try:
            await self.session.link.stop(op)
        except RefusedError as error:
            text = f"{error}: if the arm moves all the same, use the emergency stop"
            self.show_error(f"There is nothing to {op}", text)
        except ServiceError as error:
            self.show_error(
                f"{op.upper()} IS NOT CONFIRMED: use the emergency stop if the arm moves", str(error)
            )
        self._note_change()

    async def _order(
        self,
        op: str,
        failure: str,
        *,
        control: bool,
        done: str,
        then: Callable[[dict[str, Any]], None] | None,
        **fields: Any,
    ) -> None:
        from catseye.app.service.errors import RefusedError, ServiceError

        link = self.session.link
        try:
            if control and link.engine.control is None:
                await link.request("control", take=True)
            answer = await link.request(op, **fields)
        except (RefusedError, ServiceError) as error:
            self.show_error(failure, str(error))
            return
        if done:
            self.notify(done)
        if then is not None:
            then(answer)
        self._note_change()

    def _quit_as_chosen(self, choice: Choice | None) -> None:
        if choice is not None:
            self.keep(self._end_run_and_leave(choice))

    async def _end_run_and_leave(self, choice: Choice) -> None:
        from catseye.app.service.errors import RefusedError, ServiceError

        link = self.session.link
        try:
            if choice == "hold":
                await link.request("hold")
            if choice == "stop":
                await link.stop("stop")
                async with asyncio.timeout(_STANDSTILL_S):
                    await self._ended.wait()
        except (RefusedError, ServiceError) as error:
            self.show_error(f"The run could not be told to {choice}", str(error))
            return
        except TimeoutError:
            self.show_error(
                "The run has not ended",
                "STOP was given and the end of the run was not told: look at the arm, and use the emergency stop "
                "if it moves",
            )
            return
        await self._leave(end_engine=choice == "stop")

    async def _stop_and_leave(self) -> None:
        from catseye.app.service.errors import RefusedError, ServiceError

        try:
            await self.session.link.stop("stop")
        except ServiceError as error:
            self.show_error("The arm could not be stopped: USE THE EMERGENCY STOP if it moves", str(error))
            return
        except RefusedError:
            # It has ended meanwhile.
            pass
        await self._leave(end_engine=True)

    async def _leave(self, *, end_engine: bool) -> None:
        await self.session.link.leave(end_engine=end_engine)
        self.exit(0)

    def leave_on_signal(self, number: int) -> None:
        """End, from within a signal handler.

        Control is not given back: a run whose screen was killed is held, as the cell file says.
        """
        if self._own_loop is None:
            raise SystemExit(128 + number)
        self._own_loop.call_soon_threadsafe(self.exit, 128 + number)

    def _note_change(self) -> None:
        engine = self.session.link.engine
        if engine.running:
            self._ended.clear()
        else:
            self._ended.set()
        if engine.connected and engine.facts is not self._known_facts:
            self._known_facts = engine.facts
            look_at_cell(self)

    def _show_changes(self) -> None:
        """Paint the screen; ages grow also when nothing comes."""
        # Screens go before the timer at the end of the program.
        if not self.is_running or not self.screen_stack:
            return
        screen = self.screen_stack[0]
        if isinstance(screen, MainScreen):
            screen.show_now()
        engine = self.session.link.engine
        if self._had_control and engine.control is not None and not engine.in_control:
            self.notify(
                f"{engine.control.get('who')} ({engine.control.get('client')}) has taken control",
                severity="warning",
            )
        self._had_control = engine.in_control
        if isinstance(self.screen, QuitDialog) and not engine.running:
            self.screen.dismiss(None)
            self.notify("the run has ended meanwhile")
