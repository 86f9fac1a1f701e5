"""Drivers by name: built-in and third-party ones register in the same way, through entry points."""

import difflib
from importlib import metadata
from typing import Any

GROUP = "catseye.drivers"
"""Entry point group; each entry is a driver class.

A driver class has a classmethod `at(endpoint, clock, sink=None, **settings)` and a pydantic model `Settings` that
lists the settings. Its methods fit Robot, Interferometer or Environment by shape.
"""


def driver_names() -> tuple[str, ...]:
    """Return the names of all installed drivers."""
    return tuple(sorted({entry.name for entry in metadata.entry_points(group=GROUP)}))


def load_driver(name: str) -> Any:
    """Return a driver class.

    Args:
        name: as in the cell file: melfa-r3, line-counter, modbus-air.

    Raises:
        LookupError: no such driver is installed; the text lists those that are.
    """
    for entry in metadata.entry_points(group=GROUP, name=name):
        return entry.load()
    names = driver_names()
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.0)
    meant = (
        f", did you mean {near[0]!r}?" if near else ": reinstall the program, its entry points are missing"
    )
    raise LookupError(f"no driver {name!r} is installed; installed are {', '.join(names) or 'none'}{meant}")
