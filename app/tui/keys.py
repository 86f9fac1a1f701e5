"""Keys of the whole program, and how a user changes them.

A key is changed in `keys.toml` of the user's configuration folder: `"run.hold" = "h,f4"`. docs/terminal-ui.md lists
the names.
"""

import os
import tomllib
from pathlib import Path

from app.errors import ConfigError

STOP_KEYS = "f12"
"""Never taken away: a user's file may add keys to STOP, not remove this one."""


def keys_file() -> Path:
    """Return where a user's keys are."""
    folder = os.environ.get("XDG_CONFIG_HOME")
    return (Path(folder) if folder else Path.home() / ".config") / "catseye" / "keys.toml"


def read_keymap(path: Path) -> dict[str, str]:
    """Return a user's keys by the name of what they do; nothing when there is no file.

    Raises:
        ConfigError: the file cannot be used; the text says what a line looks like.
    """
    try:
        table = tomllib.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return {}
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise ConfigError(f'{path}: {error}; a line of it is: "go.jog" = "f5,j"') from error
    for name, keys in table.items():
        if not isinstance(keys, str) or not keys:
            raise ConfigError(f'{path}: {name} = {keys!r} is no key; write for instance "{name}" = "f5,j"')
    if "run.stop" in table and STOP_KEYS not in table["run.stop"].split(","):
        table["run.stop"] = f"{STOP_KEYS},{table['run.stop']}"
    return {str(name): str(keys) for name, keys in table.items()}
