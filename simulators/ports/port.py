"""One endpoint of one emulated device, whatever carries the bytes."""

from collections.abc import Callable
from typing import Protocol

from catseye.simulators.errors import EmulatorError
from catseye.simulators.ports.address import LineAddress, parse_address
from catseye.simulators.ports.conversation import Conversation, Faults, Wire
from catseye.simulators.ports.pty import LineListener
from catseye.simulators.ports.session import Session
from catseye.simulators.ports.tcp import TcpListener
from catseye.simulators.ports.udp import UdpListener
from catseye.simulators.world.timekeeper import TimeKeeper


class Listener(Protocol):
    """Waits for clients and starts a conversation with each."""

    async def open(self) -> None:
        """Be there for clients.

        Raises:
            OSError: the address cannot be used.
            EmulatorError: the same, with what to do.
        """
        ...

    @property
    def endpoint(self) -> str:
        """Where clients find it; known once it is open."""
        ...

    def drop(self) -> None:
        """Close the links of all clients; new ones are welcome."""
        ...

    async def close(self) -> None:
        """Drop all clients and let nobody in; may be called any number of times."""
        ...


class Port(Faults):
    """One listening endpoint of one device.

    Args:
        endpoint: where to listen, in one of the three forms of `parse_address`.
        switch_on: makes the device as it is after its power was switched on; returns what makes its sessions.
        most_clients: more at once are dropped, over TCP; None takes any number.
    """

    def __init__(
        self,
        device: str,
        protocol: str,
        endpoint: str,
        keeper: TimeKeeper,
        switch_on: Callable[[], Callable[[], Session]],
        *,
        most_clients: int | None = None,
    ) -> None:
        super().__init__(keeper)
        self.device = device
        self.protocol = protocol
        self._asked = endpoint
        self._switch_on = switch_on
        self._new_session = switch_on()
        self._most_clients = most_clients
        self._listener: Listener | None = None

    @property
    def endpoint(self) -> str:
        """Where it listens: as asked for, with the port or path that is really used once it is open."""
        return self._asked if self._listener is None else self._listener.endpoint

    async def open(self) -> None:
        """Listen.

        Raises:
            EmulatorError: the endpoint is none or cannot be used.
        """
        listener = self._made()
        try:
            await listener.open()
        except OSError as error:
            raise EmulatorError(
                f"{self.device}: cannot listen on {self._asked}: {error.strerror or error}; "
                "end the program that uses it, or choose another port (0 takes a free one)"
            ) from error
        self._listener = listener

    async def close(self) -> None:
        """Stop listening and drop every client; may be called any number of times."""
        if self._listener is not None:
            listener, self._asked, self._listener = self._listener, self._listener.endpoint, None
            await listener.close()

    def cut_power(self, duration_s: float) -> None:
        """Switch the device off for a time, bench s; what it knew is lost, and so are its links."""
        self.off_until_s = self.keeper.sync() + duration_s
        self._new_session = self._switch_on()
        self.drop()

    def drop(self) -> None:
        """Close the links of all clients; new ones are welcome."""
        if self._listener is not None:
            self._listener.drop()

    def _made(self) -> Listener:
        address = parse_address(self.device, self._asked)
        if isinstance(address, LineAddress):
            return LineListener(address, self.device, self.keeper, self._converse)
        if address.kind == "udp":
            return UdpListener(address, self._converse)
        return TcpListener(address, self._converse, self._most_clients)

    def _converse(self, wire: Wire) -> Conversation:
        return Conversation(self._new_session(), wire, self)
