"""The program: screens, keys that work everywhere, and the way out."""

import asyncio
from collections.abc import Iterable
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Final, cast

from textual.app import SystemCommand
from textual.binding import Binding, BindingType
from textual.command import DiscoveryHit, Hits
from textual.screen import Screen
from textual.system_commands import SystemCommandsProvider

from catseye.app.errors import StorageError
from catseye.app.protocol.ladder import ctrl_c_of_client
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui.cell_change import look_at_cell
from catseye.app.tui.dialogs.form_dialog import Answers, FormDialog
from catseye.app.tui.dialogs.questions import Choice, ConfirmDialog, QuitDialog
from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.main_screens import MAIN_SCREENS
from catseye.app.tui.preferences import remember_theme, remembered_theme
from catseye.app.tui.program import Program
from catseye.app.tui.screens.base import MainScreen
from catseye.app.tui.session import Session
from catseye.app.tui.start_checks import check_settings
from catseye.app.tui.themes import DARK, HIGH_CONTRAST, THEMES

if TYPE_CHECKING:
    from catseye.app.protocol.snapshot import Snapshot

_REFRESH_S: Final = 0.2
"""Screens are painted anew at most so often."""

_LOOK_S: Final = 2.0
"""Keys and cell file are looked at so long after the first screen: what that imports would delay it."""

_STANDSTILL_S: Final = 15.0

_NOTHING_RUNS: Final = "Ctrl-Q quits; F12 stops"


def bench_left(engine: EngineState) -> str:
    """Return what becomes of an emulated bench when its run is left running; empty for a real one."""
    if engine.emulated_speed is not None:
        return "the emulated bench keeps running, and ends with the engine"
    return (
        "the emulated bench keeps running as long as the program that started it" if engine.simulated else ""
    )


def _made(name: str, session: Session) -> MainScreen:
    """Return a new screen; its module is imported when it is shown for the first time."""
    module, _, kind = MAIN_SCREENS[name].where.partition(":")
    made = getattr(import_module(f"catseye.app.tui.screens.{module}"), kind)
    return cast("MainScreen", made(session))


class Actions(SystemCommandsProvider):
    """What the palette lists before anything is typed: screens first, so that Enter alone changes nothing.

    The actions stand in the order in which the program lists them; by the alphabet the first one would abort the run.
    """

    async def discover(self) -> Hits:
        """Yield the actions."""
        for command in self.app.get_system_commands(self.screen):
            if command.discover:
                yield DiscoveryHit(command.title, command.callback, help=command.help)


class CatseyeApp(Program):
    """The terminal user interface.

    Args:
        keymap: a user's keys by the name of what they do.
        screen: name of the one that is shown first.
        trouble: title and text of what went wrong before; shown at once.
        preferences: file that remembers the theme; None remembers nothing.
    """

    TITLE = "catseye"
    CSS_PATH = "styles/app.tcss"
    ENABLE_COMMAND_PALETTE = True
    COMMANDS: ClassVar[set[Any]] = {Actions}

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f12", "stop", "STOP", priority=True, id="run.stop", tooltip="stop the arm now"),
        Binding("ctrl+c", "ladder", "hold, stop, abort", show=False, priority=True, id="run.ladder"),
        Binding("h", "hold", "hold", show=False, id="run.hold", tooltip="hold at the next checkpoint"),
        Binding(
            "f8",
            "ask_to_go_on",
            "go on",
            show=False,
            id="run.go-on",
            tooltip="continues a held run: shows what will move; F8 there continues it",
        ),
        Binding("ctrl+q", "quit", "quit", priority=True, id="app.quit"),
        Binding("f1", "help", "help", id="app.help", tooltip="what the terms mean"),
        Binding(
            "question_mark",
            "keys",
            "keys",
            key_display="?",
            id="app.keys",
            tooltip="lists the keys of this screen; Enter carries one out",
        ),
        *(
            Binding(
                entry.key, f"go('{name}')", entry.title, show=False, id=f"go.{name}", tooltip=entry.tooltip
            )
            for name, entry in MAIN_SCREENS.items()
        ),
    ]

    def __init__(
        self,
        session: Session,
        keymap: dict[str, str] | None = None,
        screen: str = "bench",
        trouble: tuple[str, str] | None = None,
        preferences: Path | None = None,
    ) -> None:
        # The screen that is shown first, in place of an empty one that is made, drawn and left before it.
        self.DEFAULT_MODE = screen  # type: ignore[misc]  # is read by the instance
        super().__init__(session)
        self._own_keys = dict(keymap or {})
        self._trouble = trouble
        self._known: Snapshot | None = None
        self._had_control = False
        self._ended = asyncio.Event()
        self._unmounted = False
        self._own_loop: asyncio.AbstractEventLoop | None = None
        for theme in THEMES:
            self.register_theme(theme)
        self._preferences = preferences
        self._remembered = DARK.name
        if preferences is not None:
            self._remembered = remembered_theme(preferences, self.available_themes, DARK.name)
        self.theme = self._remembered
        for name in MAIN_SCREENS:
            self.add_mode(name, partial(_made, name, session))
        if keymap:
            self.set_keymap(keymap)

    async def on_mount(self) -> None:
        """Look for the engine, now that the first screen is shown."""
        self._own_loop = asyncio.get_running_loop()
        self.session.login.show = self._answers_of
        self.keep(self.session.link.serve(self.note_change))
        self.set_interval(_REFRESH_S, self._show_changes)
        if self._trouble is not None:
            self.show_error(*self._trouble)
        self.set_timer(_LOOK_S, self._look_at_settings)

    async def _answers_of(self, dialog: FormDialog) -> Answers | None:
        """Show a dialog to somebody who is asked before the engine is there."""
        answered: asyncio.Future[Answers | None] = asyncio.get_running_loop().create_future()

        def take(answers: Answers | None) -> None:
            # Who asked may have given up meanwhile.
            if not answered.done():
                answered.set_result(answers)

        self.push_screen(dialog, take)
        return await answered

    def action_log_in_again(self) -> None:
        """Forget user and password of the cell's controller; the next engine asks."""
        if self.session.cell is not None:
            self.keep(self.session.login.forget(self.session.cell))
        self.notify("User and password are forgotten; you are asked for them before the next engine starts.")

    def _look_at_settings(self) -> None:
        # The time may be over while the program ends.
        if not self._unmounted:
            self.keep(check_settings(self, self._own_keys))

    async def on_unmount(self) -> None:
        """Let the engine go; without a word of release it does what `on_client_lost` says."""
        self._unmounted = True
        await self.session.painter.close()
        await self.end_tasks()

    def watch_theme(self, theme: str) -> None:
        """Draw lines as strong as text where contrast is asked for."""
        self.set_class(theme == HIGH_CONTRAST.name, "-contrast")
        if self._preferences is not None and theme != self._remembered:
            self._remembered = theme
            self.keep(self._remember(self._preferences, theme))

    async def _remember(self, path: Path, theme: str) -> None:
        try:
            await asyncio.to_thread(remember_theme, path, theme)
        except StorageError as error:
            self.notify(str(error), title="the theme is not remembered", severity="warning")

    def get_system_commands(self, screen: Screen[Any]) -> Iterable[SystemCommand]:
        """Put every action of the program and of the screen into the palette; what changes nothing comes first."""
        for name, entry in MAIN_SCREENS.items():
            yield SystemCommand(f"Go to {entry.title}", entry.tooltip, partial(self.action_go, name))
        if isinstance(screen, MainScreen):
            yield from screen.commands()
            yield from screen.enlarging()
        yield SystemCommand("Hold the run", "at the next checkpoint", self.action_hold)
        yield SystemCommand("Continue the run", "after a hold; asks first", self.action_ask_to_go_on)
        yield SystemCommand("STOP", "the arm stops now; the run can be resumed", self.action_stop)
        yield SystemCommand("Abort the run", "stop, and leave only by clearing", self.action_abort)
        yield SystemCommand("Clear an abort", "after a look at the bench", self.action_clear)
        yield SystemCommand("Take control", "from whoever holds it", self.action_take_control)
        yield SystemCommand("Give control back", "the run goes on as it is", self.action_release)
        yield SystemCommand(
            "Log in again", "forget user and password of the controller", self.action_log_in_again
        )
        yield SystemCommand("Glossary", "what the terms mean", self.action_help)
        yield SystemCommand("Keys of this screen", "search them, and carry one out", self.action_keys)
        # Keys are listed once.
        yield from (one for one in super().get_system_commands(screen) if one.title != "Keys")

    def action_help(self) -> None:
        """Show what the terms mean."""
        from catseye.app.tui.dialogs.glossary_dialog import glossary_dialog

        self.push_screen(glossary_dialog())

    def action_keys(self) -> None:
        """Show the keys of what is on the screen, and carry out the one that is chosen."""
        from catseye.app.results.numbers import CONVENTION_OF_U
        from catseye.app.tui.dialogs.search_dialog import SearchDialog
        from catseye.app.tui.key_help import key_actions

        entries, actions = key_actions(self.screen)

        async def chosen(name: str | None) -> None:
            if name is None:
                return
            if actions[name].by_key_alone:
                self.notify("this lets the arm move: press its own key", severity="warning")
            else:
                await self.run_action(actions[name].action, actions[name].node)

        self.push_screen(
            SearchDialog("Keys", entries, f"Enter carries one out\n{CONVENTION_OF_U}", 12), chosen
        )

    def action_ladder(self) -> None:
        """Climb the stop ladder by a rung; which one, the engine decides by the state that it is in."""
        engine = self.session.link.engine
        match ctrl_c_of_client(
            answers=engine.connected and engine.silent_since_s is None,
            out_of_sight=engine.run_out_of_sight,
            active=engine.running or engine.jogging or bool(engine.raw) or self.begins,
        ):
            case "stop-by-every-way":
                self.action_stop()
            case "ladder":
                self.keep(self._climb())
            case "nothing":
                self.notify(_NOTHING_RUNS, title="nothing runs")

    async def action_quit(self) -> None:
        """Quit; while a run is under way ask what becomes of it, and before a command is ended that works."""
        engine = self.session.link.engine
        if engine.running and engine.run is not None:
            self.push_screen(QuitDialog(engine.run.name, bench_left(engine)), self._quit_as_chosen)
        elif self.session.under_way:
            text = f"{', '.join(self.session.under_way)}: it ends with this program; its work is lost."
            self.push_screen(
                ConfirmDialog("Work is under way", text, "quit", "stay here"), self._quit_if_agreed
            )
        else:
            self._quit_if_agreed(True)

    def _quit_if_agreed(self, agreed: bool | None) -> None:
        jogging = self.session.link.engine.jogging
        if agreed:
            self.keep(self._stop_and_leave() if jogging else self._leave(end_engine=True))

    async def _climb(self) -> None:
        from catseye.app.protocol.requests import Plain

        try:
            await self.session.link.request(Plain(op="ladder"))
        except RefusedError as error:
            self.notify(f"{error}; {_NOTHING_RUNS}", severity="warning")
        except ServiceError as error:
            self.show_error("The run was not held or stopped: use F12 if the arm moves", str(error))
        self.note_change()

    def _quit_as_chosen(self, choice: Choice | None) -> None:
        if choice is not None:
            self.keep(self._end_run_and_leave(choice))

    async def _end_run_and_leave(self, choice: Choice) -> None:
        from catseye.app.protocol.requests import Plain

        link = self.session.link
        try:
            if choice == "hold":
                await link.request(Plain(op="hold"))
            if choice == "stop":
                await link.stop("stop")
                async with asyncio.timeout(_STANDSTILL_S):
                    await self._ended.wait()
        except (RefusedError, ServiceError) as error:
            self.show_error(f"The run did not {choice}", str(error))
            return
        except TimeoutError:
            self.show_error(
                "The run has not ended",
                "STOP was sent, but the run has not reported its end: look at the arm, and use the emergency stop "
                "if it moves",
            )
            return
        await self._leave(end_engine=choice == "stop")

    async def _stop_and_leave(self) -> None:
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

    def note_change(self) -> None:
        """Wake whoever waits for the engine; look at the cell of one that was found."""
        super().note_change()
        engine = self.session.link.engine
        if engine.running:
            self._ended.clear()
        else:
            self._ended.set()
        if engine.connected and engine.snapshot is not self._known:
            self._known = engine.snapshot
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
            self.notify(f"{engine.control.text} has taken control", severity="warning")
        self._had_control = engine.in_control
        if isinstance(self.screen, QuitDialog) and not engine.running:
            self.screen.dismiss(None)
            self.notify("the run has ended meanwhile")
