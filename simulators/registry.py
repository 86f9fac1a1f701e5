"""Emulators by the name of their protocol: ours and third parties' register alike, through entry points."""

from importlib import metadata

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.emulator import Emulator, NewSession, Note
from catseye.simulators.errors import EmulatorError

GROUP = "catseye.simulators"
"""Entry point group; each entry is a subclass of `Emulator`."""


def emulator_names() -> tuple[str, ...]:
    """Return the protocols of all installed emulators, in order."""
    return tuple(sorted({entry.name for entry in metadata.entry_points(group=GROUP)}))


def load_emulator(protocol: str) -> type[Emulator]:
    """Return the emulator of a protocol.

    Raises:
        EmulatorError: none is installed, or what is registered is none; the text names those that are.
    """
    for entry in metadata.entry_points(group=GROUP, name=protocol):
        found = entry.load()
        if isinstance(found, type) and issubclass(found, Emulator):
            return found
        raise EmulatorError(f"{entry.value}, registered for {protocol!r}, is no emulator")
    names = ", ".join(emulator_names()) or "none: reinstall the program, its entry points are missing"
    raise EmulatorError(f"there is no emulator of {protocol!r}; there are {names}")


def sessions_of(context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
    """Return what makes the sessions of a device's endpoint.

    Raises:
        EmulatorError: there is no such protocol, or an option is wrong.
    """
    try:
        kind = load_emulator(device.protocol)
    except EmulatorError as error:
        raise EmulatorError(f"{device.name}: {error}") from None
    return kind.sessions(context, device, note)
