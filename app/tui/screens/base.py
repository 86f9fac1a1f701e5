"""What all main screens share: status above, stop bar and keys below, a body that shows the engine's state."""

from collections.abc import Iterable
from typing import ClassVar, cast

from textual.app import ComposeResult, SystemCommand
from textual.binding import BindingType
from textual.containers import Vertical
from textual.screen import Screen
from textual.worker import Worker, WorkerState

from catseye.app.tui.engine_state import EngineState
from catseye.app.tui.program import Program
from catseye.app.tui.session import Session
from catseye.app.tui.widgets.bars import ScreenBar, StopBar
from catseye.app.tui.widgets.key_line import KeyLine
from catseye.app.tui.widgets.status_bar import StatusBar


class MainScreen(Screen[None]):
    """A main screen. A subclass gives `SCREEN`, `body` and `show_state`."""

    SCREEN: ClassVar[str]
    """Name of this screen in `catseye.app.tui.main_screens`."""

    F8: ClassVar[str] = ""
    """What F8 does on this screen; while a run is held and asks nothing it lets that go on instead."""

    BINDINGS: ClassVar[list[BindingType]] = []
    """Keys of a subclass; every one has an id and an action in `commands`."""

    def __init__(self, session: Session) -> None:
        super().__init__()
        self.session = session

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
        """Leave F8 to the program while a run is held."""
        del parameters
        engine = self.session.link.engine
        asked = engine.run is not None and engine.run.prompt is not None
        return action != self.F8 or asked or not engine.held

    def commands(self) -> Iterable[SystemCommand]:
        """Return what this screen can do, for the palette; every action of its keys."""
        return ()

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
