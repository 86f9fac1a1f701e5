"""The line of keys below a screen or in a dialog."""

from dataclasses import dataclass
from typing import ClassVar, Final

from rich.style import Style
from rich.text import Text
from textual import events
from textual.screen import Screen
from textual.widget import Widget

_HELP: Final = "question_mark"
"""Stands first: where not every key finds room, this one names the others."""


@dataclass(frozen=True)
class _Key:
    """A key of the line: what to press, what stands there, and whether it does something now."""

    name: str
    sign: str
    does: str
    enabled: bool

    @property
    def width(self) -> int:
        """Columns that the key takes, without the gap behind it."""
        return len(self.sign) + 1 + len(self.does)


class KeyLine(Widget, can_focus=False):
    """Keys of what is shown, as one text: a widget for each, as in Textual's footer, takes half of a key's time.

    A click on a key presses it. The palette stands at the right and is never cut off.
    """

    ALLOW_SELECT = False
    COMPONENT_CLASSES: ClassVar[set[str]] = {"key-line--key", "key-line--description", "key-line--edge"}
    DEFAULT_CSS = """
    KeyLine { dock: bottom; height: 1; background: $footer-background; pointer: pointer; }
    KeyLine .key-line--key { color: $footer-key-foreground; background: $footer-key-background; text-style: bold; }
    KeyLine .key-line--description {
        color: $footer-description-foreground; background: $footer-description-background;
    }
    KeyLine .key-line--edge { color: $foreground 20%; }
    """

    def __init__(self) -> None:
        super().__init__()
        self._keys: list[_Key] = []
        self._palette: _Key | None = None

    def on_mount(self) -> None:
        """Follow the keys of the screen."""
        self.screen.bindings_updated_signal.subscribe(self, self._look)

    def on_unmount(self) -> None:
        """Follow them no longer."""
        self.screen.bindings_updated_signal.unsubscribe(self)

    def render(self) -> Text:
        """Draw the keys that find room, and the palette at the right."""
        line = Text(no_wrap=True)
        for key in self._keys:
            self._append(line, key)
            line.append(" ")
        if self._palette is not None:
            line.truncate(max(self.size.width - self._palette.width - 2, 0), pad=True)
            line.append("▏", self.get_component_rich_style("key-line--edge"))
            self._append(line, self._palette)
        return line

    def on_click(self, event: events.Click) -> None:
        """Press the key that was clicked."""
        key = self._at(event.x)
        if key is None:
            return
        if key.enabled:
            self.app.simulate_key(key.name)
        else:
            self.app.bell()

    def _look(self, screen: Screen[object]) -> None:
        if screen is not self.screen or not screen.app.app_focus:
            return
        palette = self.app.COMMAND_PALETTE_BINDING
        keys: dict[str, _Key] = {}
        palette_key = None
        for name, active in screen.active_bindings.items():
            binding = active.binding
            key = _Key(binding.key, self.app.get_key_display(binding), binding.description, active.enabled)
            if name == palette:
                palette_key = key
            elif binding.show:
                keys.setdefault(binding.action, key)
        found = sorted(keys.values(), key=lambda key: key.name != _HELP)
        if (found, palette_key) != (self._keys, self._palette):
            self._keys, self._palette = found, palette_key
            self.refresh()

    def _append(self, line: Text, key: _Key) -> None:
        look = Style() if key.enabled else Style(dim=True)
        line.append(key.sign, self.get_component_rich_style("key-line--key") + look)
        line.append(f" {key.does}", self.get_component_rich_style("key-line--description") + look)

    def _at(self, column: int) -> _Key | None:
        """Return the key at a column; the palette covers what has no room."""
        palette = self._palette
        if palette is not None and column >= self.size.width - palette.width - 2:
            return palette
        left = 0
        for key in self._keys:
            if left <= column < left + key.width:
                return key
            left += key.width + 1
        return None
