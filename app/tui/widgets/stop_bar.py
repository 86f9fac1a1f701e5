"""HOLD, STOP and ABORT, always in sight."""

from textual.app import ComposeResult
from textual.containers import Horizontal
from textual.widgets import Button, Static

from catseye.app.protocol.state import HELD
from catseye.app.tui.engine_state import EngineState


class StopBar(Horizontal):
    """One line with the buttons of the stop ladder."""

    DEFAULT_CSS = """
    StopBar { height: 1; background: $panel; }
    StopBar Button { height: 1; min-width: 12; border: none; margin: 0 1 0 0; }
    StopBar #hold { background: $warning; color: $background; }
    StopBar #stop { background: $error; color: $background; text-style: bold; }
    StopBar #abort { background: $error-darken-2; color: auto; }
    StopBar Static { width: 1fr; color: $warning; }
    """

    def compose(self) -> ComposeResult:
        """Make the buttons; they are for the mouse, the keys work everywhere."""
        for name, label in (("hold", "HOLD h"), ("stop", "STOP F12"), ("abort", "ABORT")):
            button = Button(label, id=name, action=f"app.{name}", compact=True)
            button.can_focus = False
            yield button
        yield Static("The software stop is no emergency stop.", id="warning")

    def show(self, engine: EngineState) -> None:
        """Say what HOLD does now."""
        held = engine.state in HELD and engine.running
        button = self.query_one("#hold", Button)
        button.label = "GO ON g" if held else "HOLD h"
        button.action = "app.ask_to_go_on" if held else "app.hold"
