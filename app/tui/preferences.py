"""What the program remembers between sessions: the theme."""

import json
from collections.abc import Container
from pathlib import Path
from typing import Final

from catseye.app.errors import ConfigError, StorageError
from catseye.app.files.atomic import write_atomically
from catseye.app.files.documents import read_toml
from catseye.app.tui.keys import config_folder

_THEME: Final = "theme"


def preferences_file() -> Path:
    """Return where they are remembered."""
    return config_folder() / "remembered.toml"


def remembered_theme(path: Path, known: Container[str], default: str) -> str:
    """Return the theme of the last session; the default where none is remembered, or none that is known.

    Whatever is wrong with the file, the program starts.
    """
    try:
        theme = read_toml(path).get(_THEME)
    except ConfigError:
        return default
    return theme if isinstance(theme, str) and theme in known else default


def remember_theme(path: Path, theme: str) -> None:
    """Remember a theme, whole or not at all.

    Raises:
        StorageError: it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StorageError(f"{path.parent}: {error.strerror}; the theme is not remembered") from error
    write_atomically(path, f"{_THEME} = {json.dumps(theme)}\n")
