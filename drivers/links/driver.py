"""What drivers have in common: the form of their settings, and how one behind a single link is made."""

from typing import Any, ClassVar, Protocol, Self

from pydantic import BaseModel, ConfigDict

from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Sink


class DeviceSettings(BaseModel):
    """Base of what a cell file may set of a device: no other keys, and no conversion of types."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


class LinkSettings(Protocol):
    """Settings of a device behind one link."""

    @property
    def connect_timeout_s(self) -> float:
        """How long connecting may take, real s."""
        ...


class LinkDriver(Protocol):
    """A driver of a device behind one link, beside its role; its settings have a `connect_timeout_s`."""

    Settings: ClassVar[type[Any]]

    def __init__(self, transport: Transport, clock: Clock, settings: Any) -> None: ...

    @classmethod
    def at(cls, endpoint: str, clock: Clock, sink: Sink | None = None, **settings: Any) -> Self:
        """Return a driver for an endpoint as the cell file writes it; nothing is opened yet.

        Args:
            endpoint: tcp://host:port or serial:///device?baud=…, see the class for what the device needs.
            settings: fields of `Settings`.

        Raises:
            LinkError: the endpoint is wrong.
            pydantic.ValidationError: a setting is unknown or wrong.
        """
        checked: LinkSettings = cls.Settings(**settings)
        transport = open_transport(endpoint, connect_timeout_s=checked.connect_timeout_s, sink=sink)
        return cls(transport, clock, checked)
