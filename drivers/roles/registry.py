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
        LookupError: no such driver is installed, it cannot be loaded, or it has another role; the text lists those
            that would do.
    """
    if name in installed():
        found = cast("type[DriverClass]", _loaded(installed()[name]))
        if role not in {None, _declared_role(name, found)}:
            raise LookupError(f"{name!r} is a driver of role {found.role}, not {role}")
        return found
    names = [known for known, each in working_drivers().items() if role in {None, each.role}]
    near = difflib.get_close_matches(name, names, n=1, cutoff=0.0)
    meant = (
        f"; did you mean {near[0]!r}?" if near else ": reinstall the program, its entry points are missing"
    )
    raise LookupError(f"no driver {name!r} is installed; installed are {', '.join(names) or 'none'}{meant}")


def working_drivers() -> dict[str, type[DriverClass]]:
    """Return all driver classes by name, without those that cannot be loaded: see `broken_drivers`."""
    return _all_drivers()[0]


def broken_drivers() -> dict[str, str]:
    """Return why drivers cannot be loaded, by their names; the others work without them."""
    return _all_drivers()[1]


@cache
def _all_drivers() -> tuple[dict[str, type[DriverClass]], dict[str, str]]:
    working: dict[str, type[DriverClass]] = {}
    broken: dict[str, str] = {}
    for name in driver_names():
        try:
            working[name] = load_driver(name)
        except LookupError as error:
            broken[name] = str(error)
    return working, broken


def _loaded(entry: metadata.EntryPoint) -> object:
    try:
        return entry.load()
    except Exception as error:  # what a package of somebody else does when it is imported may raise anything
        raise LookupError(why_not_loaded("driver", entry, error)) from error


def why_not_loaded(what: str, entry: metadata.EntryPoint, error: Exception) -> str:
    """Return why an entry point cannot be loaded, and what to do.

    Args:
        what: that it stands for.
    """
    package = entry.dist.name if entry.dist is not None else entry.module
    return (
        f"{what} {entry.name} of {package} cannot be loaded: {type(error).__name__}: {error}; "
        f"install {package} again, or remove it"
    )


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
