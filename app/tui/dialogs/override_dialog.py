"""Lowering the speed override while a run is under way."""

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Input, Label, Static

from catseye.app.tui.widgets.key_line import KeyLine


class OverrideDialog(ModalScreen[float | None]):
    """Asks for a lower speed override; None leaves it.

    Args:
        now_percent: the override now; None when it is not known.
    """

    DEFAULT_CSS = """
    OverrideDialog { align: center middle; }
    OverrideDialog > Vertical {
        width: 60; max-width: 95%; height: auto; border: heavy $primary; background: $surface; padding: 0 1;
    }
    OverrideDialog Label { text-style: bold; width: 100%; }
    OverrideDialog Input { background: $boost; }
    OverrideDialog #fault { color: $error; height: auto; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "back", "leave it", id="override.back")]

    def __init__(self, now_percent: float | None) -> None:
        super().__init__()
        self._now_percent = now_percent

    def compose(self) -> ComposeResult:
        """A number."""
        now = "not known" if self._now_percent is None else f"{self._now_percent:g} %"
        with Vertical():
            yield Label("Lower the speed override")
            yield Static(f"It is {now}. From here it is only lowered, before the next motion.", markup=False)
            yield Input(placeholder="percent, then Enter", compact=True)
            yield Static("", id="fault", markup=False)
            yield KeyLine()

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Take a percentage; whether it is lower the engine decides."""
        event.stop()
        try:
            percent = float(event.value)
        except ValueError:
            percent = 0.0
        if 1.0 <= percent <= 100.0:
            self.dismiss(percent)
        else:
            self.query_one("#fault", Static).update("Type a number from 1 to 100.")

    def action_back(self) -> None:
        """Leave it."""
        self.dismiss(None)
