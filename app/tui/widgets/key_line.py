"""The line of keys below a screen or in a dialog."""

from typing import Final

from textual.app import ComposeResult
from textual.binding import Binding
from textual.widgets import Footer

_HELP: Final = "question_mark"
"""Stands first: where not every key finds room, this one names the others."""


class KeyLine(Footer):
    """Keys of what is shown, made anew only when they are others: the focus moves far more often."""

    # Textual leaves a margin at the right of the palette, where a key below it shows through.
    DEFAULT_CSS = """
    KeyLine.-compact FooterKey.-command-palette { margin-right: 0; padding-right: 1; }
    """

    def __init__(self) -> None:
        super().__init__(compact=True)
        self._shown: list[tuple[Binding, bool, str]] | None = None

    def compose(self) -> ComposeResult:
        """Make the keys, once they are known."""
        self._shown = None
        keys = list(super().compose())
        # None is made before a screen is shown, which this asks for.
        if keys:
            self._shown = self._to_show()
        yield from sorted(keys, key=lambda key: getattr(key, "key", "") != _HELP)

    async def recompose(self) -> None:
        """Make the keys anew if they are others."""
        if self.is_attached and self._to_show() != self._shown:
            await super().recompose()

    def _to_show(self) -> list[tuple[Binding, bool, str]]:
        palette = self.app.COMMAND_PALETTE_BINDING
        active = self.screen.active_bindings.items()
        return [
            (each.binding, each.enabled, each.tooltip)
            for key, each in active
            if each.binding.show or key == palette
        ]
