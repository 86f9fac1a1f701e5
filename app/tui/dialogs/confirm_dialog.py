"""A question with yes or no; no is the safe answer."""

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Label, Static

from catseye.app.tui.widgets.key_line import KeyLine


class ConfirmDialog(ModalScreen[bool]):
    """Asks; y agrees, Esc does not, and Enter does nothing.

    Args:
        text: what follows from yes, and from no.
        yes: what y does, in a word or two.
        no: what Esc does.
    """

    DEFAULT_CSS = """
    ConfirmDialog { align: center middle; }
    ConfirmDialog > Vertical {
        width: 70; max-width: 95%; height: auto; border: heavy $warning; background: $surface; padding: 0 1;
    }
    ConfirmDialog Label { text-style: bold; width: 100%; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("y", "choose(True)", "yes", id="confirm.yes"),
        Binding("escape", "choose(False)", "no", id="confirm.no"),
    ]

    def __init__(self, title: str, text: str, yes: str, no: str) -> None:
        super().__init__()
        self._title = title
        self._text = text
        self._keys = f"y  {yes}      Esc  {no}"

    def compose(self) -> ComposeResult:
        """The question, and the keys."""
        with Vertical():
            yield Label(self._title, markup=False)
            yield Static(f"{self._text}\n\n{self._keys}", markup=False)
            yield KeyLine()

    def action_choose(self, agreed: bool) -> None:
        """Close with the answer."""
        self.dismiss(agreed)
