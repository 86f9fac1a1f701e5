"""An emulated bench of one's own: a cell file for emulators, and the process that serves it."""

import socket
import tomllib
from pathlib import Path
from typing import Final

from catseye.app.cell.rewriting import rewritten
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.errors import ConfigError
from catseye.app.files.documents import read_toml
from catseye.app.tui.session import EMULATED_BENCH

_PLACES: Final = (
    ("robot", "endpoint"),
    ("interferometer", "endpoint"),
    ("environment", "endpoint"),
    ("tracker", "endpoint"),
)


def emulated_cell() -> str:
    """Return a cell file whose devices are emulators at ports that are free now."""
    data = tomllib.loads(TEMPLATE)
    data["name"] = EMULATED_BENCH
    for (section, key), port in zip(_PLACES, _free_ports(len(_PLACES)), strict=True):
        data[section][key] = f"tcp://127.0.0.1:{port}"
    return rewritten(TEMPLATE, data)


def is_emulated(path: Path) -> bool:
    """Return whether a cell file was written for emulators of this program: its name says so."""
    try:
        return read_toml(path).get("name") == EMULATED_BENCH
    except ConfigError:
        return False


def free_file(folder: Path) -> Path:
    """Return the cell file of an emulated bench of before, or a name that is not taken."""
    for number in range(1, 100):
        path = folder / (f"{EMULATED_BENCH}.toml" if number == 1 else f"{EMULATED_BENCH}-{number}.toml")
        if not path.exists() or is_emulated(path):
            return path
    return folder / f"{EMULATED_BENCH}-new.toml"


def _free_ports(count: int) -> list[int]:
    """Return ports that nobody listens at."""
    holders = [socket.socket() for _ in range(count)]
    try:
        for holder in holders:
            holder.bind(("127.0.0.1", 0))
        return [int(holder.getsockname()[1]) for holder in holders]
    finally:
        for holder in holders:
            holder.close()
