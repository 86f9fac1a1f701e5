"""Drivers by name: built-in and third-party ones register in the same way, through entry points."""

import difflib
from functools import cache
from importlib import metadata
from typing import Final, cast

from catseye.drivers.roles.device import DriverClass, Role

GROUP: Final = "catseye.drivers"
"""Entry point group; each entry is a driver class that subclasses its role and fits `DriverClass`."""


@cache
def installed() -> dict[str, metadata.EntryPoint]:
    """Return the entry points of all drivers by name.

    They are looked for once in a process: each look reads the records of every installed package.
    """
    return {entry.name: entry for entry in metadata.entry_points(group=GROUP)}


def driver_names() -> tuple[str, ...]:
    """Return the names of all installed drivers; imports none of them."""
    return tuple(sorted(installed()))


def load_driver(name: str, role: Role | None = None) -> type[DriverClass]:
    """Return a driver class.

    Args:
        name: as in the cell file: melfa-r3, line-counter, modbus-air.
        role: what it has to be a driver of; None for anything.

    Raises:
        LookupError: no such driver is installed, or it has another role; the text lists those that would do.
    """
    if name in installed():
        found = cast("type[DriverClass]", installed()[name].load())
        if role not in {None, _declared_role(name, found)}:
            raise LookupError(f"{name!r} is a driver of role {found.role}, not {role}")
        return found
    names = driver_names()
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.0)
    meant = (
        f", did you mean {near[0]!r}?" if near else ": reinstall the program, its entry points are missing"
    )
    raise LookupError(f"no driver {name!r} is installed; installed are {', '.join(names) or 'none'}{meant}")


def _declared_role(name: str, found: type[DriverClass]) -> Role:
    """Return the role of what an entry point names, which may be anything.

    Raises:
        LookupError: it is no driver class.
    """
    try:
        role, _summary = found.role, found.summary
    except AttributeError as error:
        raise LookupError(
            f"driver {name!r}: {error}; a driver subclasses its role in catseye.drivers.roles and declares a summary"
        ) from None
    return role
