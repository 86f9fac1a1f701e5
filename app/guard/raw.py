"""A connection for bytes that a person sends to a robot: owned and guarded as every other motion is."""

from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

from catseye.app.guard.client import ArmGuard
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.links.guarding import GuardedTransport
from catseye.drivers.links.transport import Transport
from catseye.drivers.roles.device import Sink


class _Permitted(GuardedTransport):
    """A connection that takes bytes only while its guard permits a motion."""

    async def write(self, data: bytes) -> None:
        """Send all bytes.

        Raises:
            GuardError: nothing may move now.
            LinkError: the link is closed.
        """
        self._guard.permit()
        await super().write(data)


@asynccontextmanager
async def plain_connection(endpoint: str, sink: Sink) -> AsyncIterator[Transport]:
    """Open a connection to a device that moves nothing.

    Raises:
        LinkError: unreachable.
    """
    transport = open_transport(endpoint, sink=sink)
    try:
        await transport.open()
        yield transport
    finally:
        await transport.close()


@asynccontextmanager
async def raw_guard(endpoint: str, on_stop: Callable[[str], None]) -> AsyncIterator[ArmGuard]:
    """Have a guard for raw bytes to a robot; the arm is given back at the end, after whatever stops it until then.

    Args:
        endpoint: where the controller answers, tcp:// or serial://.
        on_stop: is called when the guard has stopped the arm.
    """
    guard = ArmGuard(endpoint)
    guard.on_stop = on_stop
    try:
        yield guard
    finally:
        await guard.let_go()


@asynccontextmanager
async def raw_connection(
    guard: ArmGuard,
    endpoint: str,
    stop: bytes | None,
    sink: Sink,
    folder: Path,
    *,
    simulated: bool,
    report: Callable[[str], None],
) -> AsyncIterator[Transport]:
    """Open a connection to a robot for raw bytes, and own it; a motion counts as under way until it is closed.

    Args:
        guard: of the arm, which it keeps when this ends.
        endpoint: where the controller answers, tcp:// or serial://.
        stop: bytes that stop the robot; None: nobody knows any.
        sink: is called with all bytes that pass.
        folder: of all runs, for the guard's log.
        report: is called with what has become of this arm since it was given back last.

    Raises:
        ArmInUseError: another program moves the arm.
        SafetyError: nothing is known to stop this robot, and it is real.
        LinkError: unreachable.
    """
    transport = open_transport(endpoint, sink=sink)
    if stop is not None:
        transport = _Permitted(transport, guard, "raw", stop)
    try:
        await transport.open()
        for text in await guard.hold("raw bytes by hand", folder, simulated=simulated):
            report(text)
        async with guard.motion():
            yield transport
    finally:
        await transport.close()
