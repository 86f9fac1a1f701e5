"""A block of inputs and outputs: door contact and stack light."""

from abc import abstractmethod
from typing import ClassVar, Literal, Protocol

from catseye.drivers.roles.device import Device, Role

Light = Literal["green", "amber", "red", "off"]


class Io(Device, Protocol):
    """A block of inputs and outputs."""

    role: ClassVar[Role] = "io"

    @abstractmethod
    async def door_closed(self) -> bool:
        """Return whether the door is closed now."""
        ...

    @abstractmethod
    async def show(self, light: Light) -> None:
        """Light one lamp and put the others out."""
        ...
