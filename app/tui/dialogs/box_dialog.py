"""What all dialogs share: a box in the middle of the screen with a title, a text and the keys."""

from typing import ClassVar, TypeVar

from textual.app import ComposeResult
from textual.binding import Binding, BindingType
from textual.containers import Vertical
from textual.screen import ModalScreen
from textual.widgets import Label, Static

from catseye.app.tui.widgets.key_line import KeyLine

Answer = TypeVar("Answer")


class BoxDialog(ModalScreen[Answer]):
    """Shows a text; a subclass gives the width, and a `body` where there is more than the text.

    The class `-warning` marks what concerns the arm or a file that somebody wants to keep.
    """

    DEFAULT_CSS = """
    BoxDialog { align: center middle; }
    BoxDialog > Vertical {
        max-width: 96%; height: auto; border: heavy $primary; background: $surface; padding: 0 1;
    }
    BoxDialog.-warning > Vertical { border: heavy $warning; }
    BoxDialog > Vertical > Label { text-style: bold; width: 100%; }
    """

    # Textual hides the keys of the program behind a dialog; these two are no less wanted there.
    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("f1", "help", "help", show=False, id="app.help", tooltip="what the terms mean"),
        Binding(
            "question_mark",
            "keys",
            "keys",
            key_display="?",
            id="app.keys",
            tooltip="lists the keys of this dialog; Enter carries one out",
        ),
    ]

    def __init__(self, title: str, text: str = "") -> None:
        super().__init__()
        self._title = title
        self._text = text

    def compose(self) -> ComposeResult:
        """Put title, body and keys together."""
        with Vertical():
            yield Label(self._title, markup=False)
            yield from self.body()
            yield KeyLine()

    async def action_help(self) -> None:
        """Show what the terms mean."""
        await self.app.run_action("help")

    async def action_keys(self) -> None:
        """Show the keys of this dialog."""
        await self.app.run_action("keys")

    def body(self) -> ComposeResult:
        """Return what stands between title and keys."""
        yield Static(self._text, markup=False)
