"""The keys of a screen as a list that can be searched and carried out."""

from dataclasses import dataclass

from textual.dom import DOMNode
from textual.screen import Screen

from catseye.app.tui.dialogs.search_dialog import Found
from catseye.app.tui.keys import lets_move


@dataclass(frozen=True)
class KeyAction:
    """What a key does.

    Attributes:
        action: as its binding has it.
        node: that has the binding.
        by_key_alone: it lets the arm move, and only its key does that.
    """

    action: str
    node: DOMNode
    by_key_alone: bool


def key_actions(screen: Screen[object]) -> tuple[tuple[Found, ...], dict[str, KeyAction]]:
    """Return the keys that do something now: those of the screen first, then those of the whole program."""
    found: dict[str, tuple[bool, list[str], str]] = {}
    actions: dict[str, KeyAction] = {}
    for active in screen.active_bindings.values():
        binding, name = active.binding, active.binding.id
        if not name or not active.enabled:
            continue
        shown = screen.app.get_key_display(binding)
        more = f": {active.tooltip}" if active.tooltip and active.tooltip != binding.description else ""
        everywhere = active.node is screen.app
        _, keys, _ = found.setdefault(name, (everywhere, [], f"{binding.description}{more}"))
        keys.append(shown)
        actions[name] = KeyAction(binding.action, active.node, lets_move(name))
    lines = [
        (everywhere, Found(name, " ".join(keys), text, "Everywhere" if everywhere else "This screen"))
        for name, (everywhere, keys, text) in found.items()
    ]
    return tuple(line for _, line in sorted(lines, key=lambda line: line[0])), actions
