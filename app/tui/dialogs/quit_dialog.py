"""Quitting while a run is under way."""

from typing import ClassVar, Literal

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Label, Static

from catseye.app.tui.widgets.key_line import KeyLine

Choice = Literal["leave", "hold", "stop"]


class QuitDialog(ModalScreen[Choice | None]):
    """Asks what becomes of the run; None goes back to it."""

    DEFAULT_CSS = """
    QuitDialog { align: center middle; }
    QuitDialog > Vertical {
        width: 66; max-width: 95%; height: auto; border: heavy $warning; background: $surface; padding: 0 1;
    }
    QuitDialog Label { text-style: bold; width: 100%; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("l", "choose('leave')", "leave it running", id="quit.leave"),
        Binding("h", "choose('hold')", "hold it", id="quit.hold"),
        Binding("s", "choose('stop')", "stop it", id="quit.stop"),
        Binding("escape", "choose('')", "stay here", id="quit.stay"),
    ]

    def __init__(self, run: str) -> None:
        super().__init__()
        self._run = run

    def compose(self) -> ComposeResult:
        """The choices with what follows from each."""
        with Vertical():
            yield Label("A run is under way")
            yield Static(
                f"{self._run}\n\n"
                "l  leave it running: the engine goes on without this screen; its questions wait\n"
                "h  hold it at the next checkpoint, then quit\n"
                "s  stop it now, wait for standstill, then quit; it can be resumed\n"
                "Esc  stay here\n\n"
                "catseye tui comes back to it at any time.",
                markup=False,
            )
            yield KeyLine()

    def action_choose(self, choice: str) -> None:
        """Take a choice."""
        match choice:
            case "leave" | "hold" | "stop":
                self.dismiss(choice)
            case _:
                self.dismiss(None)
