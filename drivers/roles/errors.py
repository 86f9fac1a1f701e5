"""What can go wrong between the program and an instrument.

Every text says what happened, where (device and endpoint) and what to do.
"""

from typing import Final

from catseye.drivers.roles.text import harmless

_LONGEST: Final = 2000
"""Characters of a text."""


class DeviceError(Exception):
    """Root of the errors of the drivers room; what an instrument said in its own words is harmless in their texts."""

    def __str__(self) -> str:
        """Return what happened, where and what to do, on one line; what was noted meanwhile stands behind it."""
        text = "; ".join([super().__str__(), *getattr(self, "__notes__", ())])
        return harmless(text, _LONGEST)


class LinkError(DeviceError):
    """The link cannot be opened, was refused or has been closed."""


class UnreachableError(LinkError):
    """The other side cannot be connected to, or floods the link: asking again does not help."""


class NotSentError(LinkError):
    """A request was kept back, since the link is out of step: nothing was sent."""


class LinkTimeoutError(LinkError):
    """No answer in time; the link is poisoned until it has been healed."""


class ProtocolError(DeviceError):
    """Bytes that the protocol does not allow."""


class WrongDeviceError(DeviceError):
    """Something else answers behind the port."""


class RefusedError(DeviceError):
    """The instrument understood the request and refused it.

    Args:
        number: the instrument's own error number.
    """

    def __init__(self, text: str, number: int) -> None:
        super().__init__(text)
        self.number = number


class AlarmError(RefusedError):
    """The controller is in alarm; motion is over until an operator has cleared it."""


class NotReadyError(RefusedError):
    """The controller refuses to move for a reason that an operator has to look at.

    Drives off, emergency stop, STOP on, pendant enabled, no operation right.
    """


class NotArrivedError(DeviceError):
    """The robot stands somewhere else than it was sent."""


class HiddenTargetError(DeviceError):
    """A tracker does not see its target: turned away, behind something, or somewhere else."""


class ProfileError(DeviceError):
    """A counter profile or register map is wrong or incomplete."""
