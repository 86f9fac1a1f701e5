"""What all main screens share: status above, stop bar and keys below, a body that shows the engine's state."""

from collections.abc import Iterable
from functools import partial
from typing import TYPE_CHECKING, ClassVar, Final, cast

from textual.app import ComposeResult, SystemCommand
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.reactive import Reactive
from textual.screen import Screen
from textual.widget import Widget
from textual.worker import Worker, WorkerState

from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.program import Program
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.bars import ScreenBar, StopBar
from catseye.app.tui.widgets.key_line import KeyLine
from catseye.app.tui.widgets.status_bar import StatusBar

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.run_events import PromptAsked

_ENLARGED: Final = ".panel, Figures, RowTable, SectionView"
"""What can be enlarged."""


class MainScreen(Screen[None]):
    """A main screen. A subclass gives `SCREEN`, `body` and `show_state`."""

    ALLOW_IN_MAXIMIZED_VIEW = "#head, #foot"
    """State, keys and STOP are never hidden by what is enlarged."""

    DEFAULT_CSS = """
    MainScreen .-maximized {
        width: 1fr !important; height: 1fr !important; max-width: 100% !important; max-height: 100% !important;
        margin: 0 !important;
    }
    """

    SCREEN: ClassVar[str]
    """Name of this screen in `catseye.app.tui.main_screens`."""

    F8: ClassVar[str] = ""
    """What F8 does on this screen; while a run is held and asks nothing it lets that go on instead."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding(
            "ctrl+l",
            "enlarge",
            "enlarge",
            show=False,
            id="screen.enlarge",
            tooltip="shows the panel with the focus, or the largest, on the whole screen; again: back",
        ),
        Binding("ctrl+l", "shrink", "back to the screen", id="screen.shrink"),
    ]
    """A subclass adds its own keys; every one has an id and an action in `commands`."""

    focused: Reactive[Widget | None] = Reactive(None, repaint=False)
    """Has the keys. Both widgets between which it moves are painted anew; Textual would paint the whole screen."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session
        self._prompt_seen: PromptAsked | None = None

    @property
    def catseye(self) -> Program:
        """The program: it gives orders to the engine and shows errors."""
        return cast("Program", self.app)

    def compose(self) -> ComposeResult:
        """Put status, body, stop bar and keys together."""
        with Vertical(id="head"):
            yield StatusBar()
            yield ScreenBar(self.SCREEN)
        yield from self.body()
        with Vertical(id="foot"):
            yield StopBar()
            yield KeyLine()

    def body(self) -> ComposeResult:
        """Return what stands between status and stop bar."""
        yield from ()

    def check_action(self, action: str, parameters: tuple[object, ...]) -> bool | None:
        """Leave F8 to the program while a run is held; what is enlarged already goes back."""
        del parameters
        if action in ("enlarge", "shrink"):
            return (action == "shrink") == (self.maximized is not None)
        engine = self.session.link.engine
        return action != self.F8 or self._open_question(engine) is not None or not engine.held

    def commands(self) -> Iterable[SystemCommand]:
        """Return what this screen can do, for the palette; every action of its keys."""
        return ()

    def enlarging(self) -> Iterable[SystemCommand]:
        """Return every panel that can be enlarged, for the palette."""
        for panel in self._large():
            if title := panel.border_title:
                enlarge = partial(self._enlarge, panel)
                yield SystemCommand(f"Enlarge: {title}", "shows this panel on the whole screen", enlarge)
        yield SystemCommand("Enlarge a panel, or back", "that with the focus", self._enlarge_or_shrink)

    def action_reset_alarm(self) -> None:
        """Show the controller's alarm; y there resets it."""
        self.catseye.action_reset_alarm()

    def action_enlarge(self) -> None:
        """Let the panel with the focus fill the screen; where none has it, the largest."""
        panels = self._large()
        above = [] if self.focused is None else list(self.focused.ancestors_with_self)
        with_focus = next((each for each in above if each in panels), None)
        largest = max(panels, key=lambda each: each.size.area, default=None)
        if (panel := with_focus or largest) is not None:
            self._enlarge(panel)

    def action_shrink(self) -> None:
        """Show the whole screen again."""
        self.minimize()
        self.refresh_bindings()

    def _enlarge_or_shrink(self) -> None:
        if self.maximized is None:
            self.action_enlarge()
        else:
            self.action_shrink()

    def _enlarge(self, panel: Widget) -> None:
        if self._open_question(self.session.link.engine) is not None:
            self.notify("a question is open: no panel may cover it", severity="warning")
            return
        self.maximized = panel
        self.refresh_bindings()

    def _large(self) -> list[Widget]:
        """Return what can be enlarged and is seen."""
        return [
            each for each in self.query(_ENLARGED).results(Widget) if each.size.area and each.is_on_screen
        ]

    def on_screen_resume(self) -> None:
        """Show at once what has happened while another screen was shown."""
        self.show_now()

    def on_worker_state_changed(self, event: Worker.StateChanged) -> None:
        """Show that work failed by a fault of the program; every other failure is shown where it happens."""
        if event.state is WorkerState.ERROR and event.worker.error is not None:
            self.catseye.show_fault(event.worker.error)

    def show_now(self) -> None:
        """Show the state as it is now; called at most five times a second, and after orders."""
        # A screen is resumed before its widgets stand on it.
        if not self.is_mounted or not self.query(StopBar):
            return
        engine, now_s = self.session.link.engine, self.session.now_s()
        self._uncover_question(engine)
        self.query_one(StatusBar).show(engine, now_s)
        self.query_one(StopBar).show(engine)
        try:
            self.show_state(engine, now_s)
        except Exception as error:  # noqa: BLE001  # a panel that fails takes neither STOP nor the program with it
            self.catseye.show_fault(error)

    def show_state(self, engine: EngineState, now_s: float) -> None:
        """Show what concerns this screen.

        Args:
            now_s: monotonic time, s.
        """

    def _uncover_question(self, engine: EngineState) -> None:
        """Show the whole screen when a run begins to wait for somebody."""
        asked = self._open_question(engine)
        if asked is not self._prompt_seen:
            self._prompt_seen = asked
            if asked is not None and self.maximized is not None:
                self.action_shrink()

    @staticmethod
    def _open_question(engine: EngineState) -> "PromptAsked | None":
        """Return the open question."""
        return None if engine.run is None else engine.run.prompt
