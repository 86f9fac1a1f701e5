"""An emulated bench of one's own: a cell file for emulators, and the process that serves it."""

import socket
import tomllib
from pathlib import Path
from typing import Final

from catseye.app.cell.rewriting import rewritten
from catseye.app.cell.templates import RESOLUTION, SCARA, SIX_AXIS, TEMPLATES
from catseye.app.errors import ConfigError
from catseye.app.files.documents import read_toml
from catseye.app.tui.session import EMULATED_ARM, EMULATED_BENCH, EMULATED_TRACKER

_NAMES: Final = {SCARA: EMULATED_BENCH, RESOLUTION: EMULATED_ARM, SIX_AXIS: EMULATED_TRACKER}
"""Of the cells, by system."""

_PLACES: Final = (
    ("robot", "endpoint"),
    ("interferometer", "endpoint"),
    ("environment", "endpoint"),
    ("tracker", "endpoint"),
    ("tracker", "control"),
)


def emulated_cell(system: str) -> str:
    """Return a cell file whose devices are emulators at ports that are free now.

    Args:
        system: name of its template.
    """
    template = TEMPLATES[system].text
    data = tomllib.loads(template)
    data["name"] = _NAMES[system]
    places = [(section, key) for section, key in _PLACES if key in data.get(section, {})]
    for (section, key), port in zip(places, _free_ports(len(places)), strict=True):
        data[section][key] = f"tcp://127.0.0.1:{port}"
    return rewritten(template, data)


def is_emulated(path: Path, system: str) -> bool:
    """Return whether a cell file was written for emulators of this program: its name says so."""
    try:
        return read_toml(path).get("name") == _NAMES[system]
    except ConfigError:
        return False


def free_file(folder: Path, system: str) -> Path:
    """Return the cell file of an emulated bench of before, or a name that is not taken."""
    name = _NAMES[system]
    for number in range(1, 100):
        path = folder / (f"{name}.toml" if number == 1 else f"{name}-{number}.toml")
        if not path.exists() or is_emulated(path, system):
            return path
    return folder / f"{name}-new.toml"


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
