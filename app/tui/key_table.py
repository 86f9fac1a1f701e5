"""Every key of the program by the name of what it does, read from the bindings themselves."""

import importlib
import pkgutil
import re
from collections.abc import Iterator
from dataclasses import dataclass
from types import ModuleType

from textual.binding import Binding

from catseye.app import tui

_EVERYWHERE = "CatseyeApp"


@dataclass(frozen=True)
class Key:
    """A key.

    Attributes:
        where: it works.
        name: that `keys.toml` calls it by.
        keys: as they are written there.
        text: what it does.
    """

    where: str
    name: str
    keys: str
    text: str


def key_table() -> tuple[Key, ...]:
    """Return every key that has a name: those that work everywhere first, then by screen and dialog.

    It imports all screens and dialogs.
    """
    found = {key for module in _modules() for key in _keys_of(module)}
    return tuple(sorted(found, key=lambda key: (key.where != "everywhere", key.where, key.name)))


def key_table_markdown() -> str:
    """Return the table as docs/terminal-ui.md has it."""
    rows = [f"| {key.where} | `{key.keys}` | {key.text} | `{key.name}` |" for key in key_table()]
    return "\n".join(["| where | key | does | name |", "|---|---|---|---|", *rows])


def _modules() -> Iterator[ModuleType]:
    for found in pkgutil.walk_packages(tui.__path__, f"{tui.__name__}."):
        yield importlib.import_module(found.name)


def _keys_of(module: ModuleType) -> Iterator[Key]:
    for kind in vars(module).values():
        if not isinstance(kind, type) or kind.__module__ != module.__name__:
            continue
        for binding in vars(kind).get("BINDINGS", ()):
            if isinstance(binding, Binding) and binding.id:
                text = binding.description
                more = f": {binding.tooltip}" if binding.tooltip not in {"", text} else ""
                yield Key(_where(kind), binding.id, binding.key, f"{text}{more}")


def _where(kind: type) -> str:
    """Return the name of a screen, dialog or part, in words."""
    if kind.__name__ == _EVERYWHERE:
        return "everywhere"
    words = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", kind.__name__.removesuffix("Screen"))
    return f"{words[:1]}{words[1:].lower()}"
