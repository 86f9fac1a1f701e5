"""Keys of the whole program, and how a user changes them.

A key is changed in `keys.toml` of the user's configuration folder: `"run.hold" = "h,insert"`. docs/terminal-ui.md
lists the names.
"""

import os
from pathlib import Path
from typing import Final

from catseye.app.errors import ConfigError
from catseye.app.files.documents import read_toml

STOP_KEYS = "f12"
"""Never taken away: a user's file may add keys to STOP, not remove this one."""

_OWNERS: Final = {STOP_KEYS: "run.stop", "ctrl+c": "run.ladder"}
"""Keys that stop, and the only names that may have them."""

_MOTION: Final = frozenset(
    {"motion.confirm", "run.move", "run.walk", "start.begin", "jog.begin", "terminal.send"}
)
"""What lets the arm move; Enter, which is pressed without a thought, never does."""

_JOGGED: Final = (
    "jog.j1-",
    "jog.j2-",
    "jog.j4-",
    "jog.beam-",
    "jog.axis-minus",
    "jog.axis-plus",
    "jog.point",
)
"""Beginnings of the names of keys that move the arm once the jog has begun."""


_SHOWN: Final = 80
"""Characters of a value that is none."""


def lets_move(name: str) -> bool:
    """Return whether a key lets the arm move: it does so by itself alone, never from a list or a palette."""
    return name in _MOTION or name == "run.go-on" or name.startswith(_JOGGED)


def config_folder() -> Path:
    """Return where a user's settings are."""
    folder = os.environ.get("XDG_CONFIG_HOME")
    return (Path(folder) if folder else Path.home() / ".config") / "catseye"


def keys_file() -> Path:
    """Return where a user's keys are."""
    return config_folder() / "keys.toml"


def read_keymap(path: Path) -> dict[str, str]:
    """Return a user's keys by the name of what they do; nothing when there is no file.

    Raises:
        ConfigError: the file cannot be used; the text says what a line looks like.
    """
    if not path.exists():
        return {}
    try:
        table = read_toml(path)
    except ConfigError as error:
        raise ConfigError(f'{error}; a line of it is: "go.jog" = "f5,j"') from error
    for name, keys in table.items():
        if not isinstance(keys, str) or not keys:
            raise ConfigError(
                f'{path}: {name} = {repr(keys)[:_SHOWN]} is no key; write for instance "{name}" = "f5,j"'
            )
    keymap = {name: [key.strip() for key in keys.split(",")] for name, keys in table.items()}
    for name, keys in keymap.items():
        _check(path, name, keys)
    for key, name in _OWNERS.items():
        if name in keymap and key not in keymap[name]:
            keymap[name].insert(0, key)
    return {name: ",".join(keys) for name, keys in keymap.items()}


def _check(path: Path, name: str, keys: list[str]) -> None:
    for key in keys:
        if not key:
            raise ConfigError(f'{path}: {name}: a key is missing; write for instance "{name}" = "f5,j"')
        if _OWNERS.get(key, name) != name:
            raise ConfigError(
                f"{path}: {name} = {key!r}: this key stops the arm and does nothing else; take another one"
            )
        if key == "enter" and name in _MOTION:
            raise ConfigError(
                f"{path}: {name}: Enter never lets the arm move; take a key that nobody presses in passing"
            )
