"""Reading a description, of an arm or of a tool: faults name file and key."""

from importlib.resources.abc import Traversable
from pathlib import Path
from typing import Generic, TypeVar

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from catseye.app.cell.faults import fault_text
from catseye.app.errors import ConfigError
from catseye.app.files.documents import document_text, parse_toml, read_document

Described = TypeVar("Described", bound=BaseModel)

_MOST_FAULTS = 20
_UNKNOWN = "unknown key: docs/files.md lists those of a description"


def read_described(kind: type[Described], path: Path) -> Described:
    """Read a description.

    Raises:
        ConfigError: the file is missing or no TOML, or keys or values are wrong; the faults are listed.
    """
    text = document_text(read_document(path, "there is no such file: give the path of a description"), path)
    try:
        return kind.model_validate(parse_toml(text, path))
    except ValidationError as error:
        faults = "\n".join(
            f"  {path}: {_place(fault)}: {fault_text(fault, lambda: _UNKNOWN)}"
            for fault in error.errors()[:_MOST_FAULTS]
        )
        raise ConfigError(f"the description cannot be used:\n{faults}") from error


class Shipped(Generic[Described]):
    """Descriptions of one kind that come with the program, and those of a user's own.

    Args:
        kind: what is described.
        what: a word for it: arm.
        folder: of the shipped files.
    """

    def __init__(self, kind: type[Described], what: str, folder: Traversable) -> None:
        self._kind, self._what, self._folder = kind, what, folder
        self._read: dict[str, Described] = {}

    def names(self) -> list[str]:
        """Return the names of those that come with the program."""
        files = [entry.name for entry in self._folder.iterdir() if entry.name.endswith(".toml")]
        return sorted(name.removesuffix(".toml") for name in files)

    def named(self, name: str) -> Described:
        """Return one that comes with the program; each is read once.

        Raises:
            ValueError: there is none of that name.
        """
        if name not in self._read:
            if name not in self.names():
                raise ValueError(
                    f"there is no description of {self._what} {name}; there are {', '.join(self.names())}"
                )
            self._read[name] = read_described(self._kind, Path(str(self._folder / f"{name}.toml")))
        return self._read[name]

    def of(self, text: str | Described) -> Described:
        """Return the description that a name or a path means; a description is returned as it is.

        Raises:
            ConfigError: the file cannot be read or is no description; the fault is named with its key.
            ValueError: there is none of that name.
        """
        if not isinstance(text, str):
            return text
        return read_described(self._kind, Path(text)) if is_path(text) else self.named(text)


def is_path(text: str) -> bool:
    """Return whether text means a file, and not the name of a shipped description."""
    return text.endswith(".toml") or "/" in text or "\\" in text


def _place(fault: ErrorDetails) -> str:
    """Return where a fault is, the tables of a list counted from 1: `joint[2].a_mm`."""
    parts = [f"[{part + 1}]" if isinstance(part, int) else f".{part}" for part in fault["loc"]]
    return "".join(parts).removeprefix(".") or "file"
