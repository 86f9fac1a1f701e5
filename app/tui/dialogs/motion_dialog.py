"""A motion that is confirmed by the key for motion."""

from typing import ClassVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Label, Static

from catseye.app.tui.widgets.key_line import KeyLine


class MotionDialog(ModalScreen[bool]):
    """Says what will move, how far and how fast; F8 has it done."""

    DEFAULT_CSS = """
    MotionDialog { align: center middle; }
    MotionDialog > Vertical {
        width: 66; max-width: 95%; height: auto; border: heavy $warning; background: $surface; padding: 0 1;
    }
    MotionDialog Label { text-style: bold; color: $warning; width: 100%; }
    """

    BINDINGS: ClassVar[list[BindingType]] = [
        # Keys in the footer can be clicked: this one is in the text.
        Binding("f8", "choose(True)", "move", show=False, id="motion.confirm", tooltip="the arm moves"),
        Binding("escape", "choose(False)", "do not move", id="motion.refuse"),
    ]

    def __init__(self, title: str, text: str) -> None:
        super().__init__()
        self._title = title
        self._text = text

    def compose(self) -> ComposeResult:
        """What moves, and the keys."""
        with Vertical():
            yield Label(self._title, markup=False)
            yield Static(f"{self._text}\n\nF8  move    Esc  do not move", markup=False)
            yield KeyLine()

    def action_choose(self, move: bool) -> None:
        """Close with the decision."""
        self.dismiss(move)
