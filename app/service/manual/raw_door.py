"""The door of a cell while bytes are sent to its arm by hand."""

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager

from catseye.app.engine.door_watch import DoorWatch
from catseye.app.errors import SafetyError
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.io import Io


class RawDoor:
    """Passes bytes on while the door is closed; when it opens, STOP goes out before anybody is notified.

    Args:
        transport: of the robot's controller; it is open.
        stop: bytes that stop the arm, whatever was written before; None: its driver knows none.
        on_open: called when the door has opened, with what it says.

    Attributes:
        watch: of the door; None where no door is watched.
    """

    def __init__(self, transport: Transport, stop: bytes | None, on_open: Callable[[str], None]) -> None:
        self._transport = transport
        self._stop = stop
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
        self._on_open(f"{trouble}; {self._written_stop() or 'STOP was sent'}")

    def stop(self) -> None:
        """Write STOP now, past what waits and past a guard that lets nothing else pass."""
        if failure := self._written_stop():
            self._on_open(failure)

    def _written_stop(self) -> str:
        if self._stop is None:
            return "this robot's driver knows no STOP: PRESS THE EMERGENCY STOP if the arm moves"
        try:
            self._transport.send_urgent(self._stop)
        except DeviceError as error:
            return f"STOP cannot be sent: PRESS THE EMERGENCY STOP if the arm moves ({error})"
        return ""


@asynccontextmanager
async def raw_door(
    io: Io | None,
    transport: Transport,
    stop: bytes | None,
    clock: Clock,
    on_open: Callable[[str], None],
) -> AsyncIterator[RawDoor]:
    """Watch the door of a cell meanwhile.

    Args:
        io: block with the interlock; None where no door is watched.
        transport: of the robot's controller.
        stop: bytes that stop the arm; None: its driver knows none.
        clock: real time.
        on_open: called when the door has opened, with what it says.
    """
    door = RawDoor(transport, stop, on_open)
    if io is None:
        yield door
        return
    door.watch = DoorWatch(io, clock, door.opened)
    # A watch that ends counts as an open door.
    async with door.watch.watching(door.opened):
        yield door
