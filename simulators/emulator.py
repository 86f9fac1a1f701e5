"""What an emulator is: one endpoint of one device, with the options and the role that its class declares.

Ours and third parties' are found by the name of their protocol, through entry points.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable
from importlib import metadata
from typing import ClassVar, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.context import EmulationContext
from catseye.simulators.errors import EmulatorError
from catseye.simulators.ports.session import Session

GROUP = "catseye.simulators"
"""Entry point group; each entry is a subclass of `Emulator`."""

Note = Callable[[str], None]
"""Called with each request of a client."""

NewSession = Callable[[], Session]
"""Makes the session of a new client."""

Role = Literal["robot", "interferometer", "environment", "io", "tracker"]


class DeviceOptions(BaseModel):
    """Options of an emulated device; keys that only its driver knows are left alone.

    Attributes:
        clients: most clients at once over TCP; 0: any number.
    """

    model_config = ConfigDict(strict=True, frozen=True, extra="ignore", allow_inf_nan=False)

    clients: int = Field(default=0, ge=0, le=100)

    @classmethod
    def of(cls, device: EmulatedDevice) -> Self:
        """Read the options of a device.

        Raises:
            EmulatorError: one of them is wrong; the text names device and option.
        """
        try:
            return cls.model_validate(dict(device.options))
        except ValidationError as error:
            first = error.errors()[0]
            key = ".".join(map(str, first["loc"]))
            raise EmulatorError(
                f"{device.name}: option {key}: {first['msg']}, found {first['input']!r}"
            ) from None


class Emulator(ABC):
    """One endpoint of one device.

    Attributes:
        role: what kind of device it emulates.
        arm: of a robot's, what its controller drives; of others it means nothing.
        Options: its options.
        link: what carries its bytes where no endpoint says so.
    """

    role: ClassVar[Role]
    arm: ClassVar[Literal["scara", "serial"]] = "scara"
    Options: ClassVar[type[DeviceOptions]] = DeviceOptions
    link: ClassVar[Literal["tcp", "udp"]] = "tcp"

    @classmethod
    def most_clients(cls, device: EmulatedDevice) -> int | None:
        """Return how many clients a device serves at once over TCP, None for any number."""
        return DeviceOptions.of(device).clients or None

    @classmethod
    @abstractmethod
    def sessions(cls, context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
        """Make what all clients of the endpoint share.

        Args:
            note: called with each request.

        Returns:
            What makes the session of a new client.

        Raises:
            EmulatorError: an option is wrong.
        """


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


def emulator_of(device: EmulatedDevice) -> type[Emulator]:
    """Return the emulator of a device.

    Raises:
        EmulatorError: there is no such protocol.
    """
    try:
        return load_emulator(device.protocol)
    except EmulatorError as error:
        raise EmulatorError(f"{device.name}: {error}") from None


def sessions_of(context: EmulationContext, device: EmulatedDevice, note: Note) -> NewSession:
    """Return what makes the sessions of a device's endpoint.

    Raises:
        EmulatorError: there is no such protocol, or an option is wrong.
    """
    return emulator_of(device).sessions(context, device, note)
