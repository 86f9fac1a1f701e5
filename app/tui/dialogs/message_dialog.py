"""What dialogs with a text share: they are closed by Esc or Enter, and title and text can be copied."""

from typing import ClassVar

from textual.binding import Binding, BindingType

from catseye.app.tui.dialogs.box_dialog import BoxDialog


class MessageDialog(BoxDialog[None]):
    """A title and a text."""

    BINDINGS: ClassVar[list[BindingType]] = [
        Binding("escape,enter", "dismiss_it", "close", id="dialog.close"),
        Binding("c", "copy", "copy the text", id="dialog.copy"),
    ]

    def action_dismiss_it(self) -> None:
        """Close."""
        self.dismiss()

    def action_copy(self) -> None:
        """Put title and text on the clipboard."""
        self.app.copy_to_clipboard(f"{self._title}\n{self._text}")
        self.notify("copied")
