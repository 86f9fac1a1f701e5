"""Lowering the speed override while a run is under way."""

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.widgets import Input, Static

from catseye.app.tui.dialogs.box_dialog import BoxDialog


class OverrideDialog(BoxDialog[float | None]):
    """Asks for a lower speed override; None leaves it.

    Args:
        now_percent: the override now; None when it is not known.
    """

    DEFAULT_CSS = """
    OverrideDialog > Vertical { width: 60; }
    OverrideDialog Input { background: $boost; }
    OverrideDialog #fault { color: $error; height: auto; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [Binding("escape", "back", "leave it", id="override.back")]

    def __init__(self, now_percent: float | None) -> None:
        now = "not known" if now_percent is None else f"{now_percent:g} %"
        text = f"It is {now}. From here it is only lowered, before the next motion."
        super().__init__("Lower the speed override", text)

    def body(self) -> ComposeResult:
        """A number."""
        yield from super().body()
        yield Input(placeholder="percent, then Enter", compact=True)
        yield Static("", id="fault", markup=False)

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
