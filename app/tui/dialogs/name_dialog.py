"""Asks for the name of a file."""

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Footer, Input, Label


class NameDialog(ModalScreen[str | None]):
    """A name, or None when nothing is to be done.

    Args:
        title: what it is for.
        name: proposed.
    """

    DEFAULT_CSS = """
    NameDialog { align: center middle; }
    NameDialog > Vertical {
        width: 66; max-width: 95%; height: auto; border: heavy $primary; background: $surface; padding: 0 1;
    }
    NameDialog Label { text-style: bold; width: 100%; }
    NameDialog Input { background: $boost; margin: 1 0; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape", "back", "back", id="name.back"),
    ]

    def __init__(self, title: str, name: str) -> None:
        super().__init__()
        self._title = title
        self._name = name

    def compose(self) -> ComposeResult:
        """Title and name."""
        with Vertical():
            yield Label(self._title, markup=False)
            yield Input(self._name, compact=True, select_on_focus=True)
            yield Footer(compact=True)

    def on_input_submitted(self, event: Input.Submitted) -> None:
        """Take the name."""
        event.stop()
        self.dismiss(event.value.strip() or None)

    def action_back(self) -> None:
        """Do nothing."""
        self.dismiss(None)
