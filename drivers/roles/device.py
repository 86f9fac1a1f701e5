"""What all instruments have in common, and what a driver class declares before it is made."""

from abc import abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, Final, Literal, Protocol, Self, get_args

from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.text import DeviceText

Role = Literal["robot", "interferometer", "environment", "tracker", "io"]
"""What an instrument is for; the names are those of the sections of a cell file."""

ROLES: Final[tuple[Role, ...]] = get_args(Role)

Direction = Literal["tx", "rx"]
"""Seen from the program: tx is sent, rx is received."""

Entry = Direction | Literal["heal"]
"""What an entry of a transcript holds: bytes that passed, or why the connection is healed, as text in UTF-8."""

Sink = Callable[[Entry, bytes], None]
"""Called with everything that passes a connection, and with each healing of it; must neither block nor raise."""


@dataclass(frozen=True)
class Identity(DeviceText):
    """Who answers behind an endpoint.

    Attributes:
        model: what the instrument calls itself.
        firmware: version text, empty when unknown.
        serial: serial number text, empty when unknown.
        simulated: True when the instrument says that it is an emulator.
    """

    model: str
    firmware: str
    serial: str
    simulated: bool


@dataclass(frozen=True)
class Examination:
    """What a driver found out about its instrument beyond the role, for `catseye doctor`.

    Attributes:
        facts: one line each.
        advice: what is wrong and what to do, one line each.
    """

    facts: tuple[str, ...] = ()
    advice: tuple[str, ...] = ()


@dataclass(frozen=True)
class LoginVariables:
    """Variables of the environment in which a driver looks for user and password.

    Attributes:
        user: name of the variable with the user.
        password: name of the variable with the password.
        factory_user: what the maker calls the user of a new instrument.
    """

    user: str
    password: str
    factory_user: str


class Device(Protocol):
    """An instrument on a link.

    Attributes:
        protocols: that the driver speaks, as emulators are called, by the endpoints that `at` takes; None for one of
            the driver's own name on its only endpoint.
        login_variables: of an instrument that asks for user and password; None for one that does not.
    """

    protocols: ClassVar[Mapping[str, str] | None] = None
    login_variables: ClassVar[LoginVariables | None] = None

    @classmethod
    def profiles(cls) -> Mapping[str, str]:
        """Return the files that come with the driver by name: a person copies one and completes it."""
        return {}

    @property
    def notes(self) -> tuple[str, ...]:
        """What the driver knows about its connection and a person should know, one sentence each."""
        return ()

    @abstractmethod
    async def connect(self) -> Identity:
        """Open the link and check who answers.

        Raises:
            DeviceError: nobody answers, or somebody else.
        """
        ...

    @abstractmethod
    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        ...

    async def examine(self) -> Examination:
        """Ask a connected instrument what its maker provides beyond the role."""
        return Examination()


class DriverClass(Protocol):
    """A driver as it is registered: the class, before anything is connected.

    Attributes:
        role: what it is a driver of.
        summary: one line for the wizard: maker, model, link.
        protocols: see `Device`.
        login_variables: see `Device`.
        Settings: pydantic model of its settings; unknown keys are refused.
    """

    role: ClassVar[Role]
    protocols: ClassVar[Mapping[str, str] | None]
    login_variables: ClassVar[LoginVariables | None]
    summary: ClassVar[str]
    Settings: ClassVar[type[Any]]

    @classmethod
    def profiles(cls) -> Mapping[str, str]:
        """Return the files that come with the driver by name: see `Device`."""
        ...

    @classmethod
    def at(cls, endpoint: str, clock: Clock, sink: Sink | None = None, **settings: Any) -> Self:
        """Return a driver for an endpoint as a cell file writes it; nothing is opened yet.

        Raises:
            DeviceError: the endpoint is none.
            ValidationError: of pydantic, a setting is wrong.
        """
        ...
