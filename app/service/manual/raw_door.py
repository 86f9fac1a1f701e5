"""The door of a cell while bytes are sent to its arm by hand."""

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

from catseye.app.engine.door_watch import DoorWatch
from catseye.app.errors import SafetyError
from catseye.drivers.links.transport import Transport
from catseye.drivers.melfa.codec import encode
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.io import Io

_STOP = b"\r" + encode("STOP")
"""After what may be half a request, in a request of its own."""


class RawDoor:
    """Passes bytes on while the door is closed; when it opens, STOP goes out before anybody is notified.

    Args:
        transport: of the robot's controller; it is open.
        on_open: called when the door has opened, with what it says.

    Attributes:
        watch: of the door; None where no door is watched.
    """

    def __init__(self, transport: Transport, on_open: Callable[[str], None]) -> None:
        self._transport = transport
        self._on_open = on_open
        self._open = False
        self.watch: DoorWatch | None = None

    def require_closed(self) -> None:
        """Check that bytes may pass.

        Raises:
            SafetyError: the door is open or does not answer.
        """
        if self.watch is not None and self.watch.trouble is not None:
            raise SafetyError(self.watch.trouble)
        self._open = False

    def opened(self, trouble: str) -> None:
        """Stop the arm, once each time that the door is opened."""
        if self._open:
            return
        self._open = True
        failure = self._written_stop()
        self._on_open(trouble)
        if failure:
            self._on_open(failure)

    def stop(self) -> None:
        """Write STOP now, past what waits and past a guard that lets nothing else pass."""
        if failure := self._written_stop():
            self._on_open(failure)

    def _written_stop(self) -> str:
        try:
            self._transport.send_urgent(_STOP)
        except DeviceError as error:
            return f"STOP cannot be sent: PRESS THE EMERGENCY STOP if the arm moves ({error})"
        return ""


@asynccontextmanager
async def raw_door(
    io: Io | None,
    transport: Transport,
    clock: Clock,
    on_open: Callable[[str], None],
) -> AsyncIterator[RawDoor]:
    """Watch the door of a cell meanwhile.

    Args:
        io: block with the interlock; None where no door is watched.
        transport: of the robot's controller.
        clock: real time.
        on_open: called when the door has opened, with what it says.
    """
    door = RawDoor(transport, on_open)
    if io is None:
        yield door
        return
    door.watch = DoorWatch(io, clock, door.opened)
    # A watch that ends counts as an open door.
    async with door.watch.watching(door.opened):
        yield door
