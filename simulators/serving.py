"""TCP ports that let clients talk with sessions; sessions know bytes, ports know sockets.

A session carries out one request after the other, in order. What takes bench time is a `Pending` answer; requests
that come meanwhile wait. asyncio switches Nagle's algorithm off on every TCP socket, so an answer leaves at once.
"""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass
from urllib.parse import urlsplit

from simulators.errors import EmulatorError
from simulators.timekeeper import TimeKeeper

_BACKLOG_BYTES = 65_536


@dataclass(frozen=True)
class Pending:
    """An answer that is due later.

    Attributes:
        due: bench time to wait for, None when the answer is due; see `TimeKeeper.wait`.
        reply: makes the answer.
    """

    due: Callable[[], float | None]
    reply: Callable[[], bytes]


Answer = bytes | Pending
"""What a session says to one request; empty bytes: nothing."""


class Session:
    """One client's conversation. Bytes go in, answers come out; no socket, no clock."""

    def feed(self, data: bytes) -> None:
        """Take what the client sent, cut anywhere."""
        raise NotImplementedError

    def answer(self) -> Answer | None:
        """Carry out the next complete request and answer it; None when there is none."""
        raise NotImplementedError

    def silence_s(self) -> float | None:
        """Return the real time, s, after which silence completes what has come; None: silence means nothing."""
        return None

    def idle(self) -> None:
        """Take note that the client was silent for that time."""

    def next_output_s(self) -> float | None:
        """Return the bench time of the next unrequested output, None for none."""
        return None

    def output(self) -> bytes:
        """Return the unrequested output that is due."""
        return b""

    def close(self) -> None:
        """Take note that the client is gone."""


class Port:
    """One listening endpoint of one device.

    Args:
        device: name of the device.
        protocol: name of the protocol.
        endpoint: where to listen, `tcp://host:port`; port 0 takes a free one.
        keeper: bench time.
        session: makes the session of a new client.
    """

    def __init__(
        self, device: str, protocol: str, endpoint: str, keeper: TimeKeeper, session: Callable[[], Session]
    ) -> None:
        self.device = device
        self.protocol = protocol
        self.endpoint = endpoint
        self.keeper = keeper
        self.new_session = session
        self.muted = False
        self.stalled_until_s = 0.0
        self.closing = False
        self._server: asyncio.Server | None = None
        self._connections: set[Connection] = set()

    async def open(self) -> None:
        """Listen.

        Raises:
            EmulatorError: the endpoint is not a TCP address or is in use.
        """
        host, port = _address(self.device, self.endpoint)
        loop = asyncio.get_running_loop()
        try:
            self._server = await loop.create_server(lambda: Connection(self), host, port)
        except OSError as error:
            raise EmulatorError(
                f"{self.device}: cannot listen on {self.endpoint}: {error.strerror or error}; "
                "end the program that uses it, or choose another port (0 takes a free one)"
            ) from error
        bound = self._server.sockets[0].getsockname()
        name = f"[{host}]" if ":" in host else host
        self.endpoint = f"tcp://{name}:{bound[1]}"

    async def close(self) -> None:
        """Stop listening and drop every client; may be called any number of times."""
        self.closing = True
        if self._server is not None:
            self._server.close()
            # A client that was accepted in this very turn of the loop joins in the next one.
            await asyncio.sleep(0)
        gone = [connection.gone for connection in self._connections]
        self.drop()
        if gone:
            await asyncio.wait(gone)
        if self._server is not None:
            await self._server.wait_closed()
        self._server = None

    def drop(self) -> None:
        """Close the connections of all clients; new ones are welcome."""
        for connection in list(self._connections):
            connection.abort()

    def joined(self, connection: "Connection") -> None:
        """Take note of a new client."""
        self._connections.add(connection)

    def left(self, connection: "Connection") -> None:
        """Take note that a client is gone."""
        self._connections.discard(connection)

    def stall(self) -> Pending | None:
        """Return what to wait for while the device hangs, None while it works."""
        if self.keeper.sync() >= self.stalled_until_s:
            return None
        return Pending(self._stall_due, lambda: b"")

    def _stall_due(self) -> float | None:
        return self.stalled_until_s if self.keeper.bench.time_s < self.stalled_until_s else None


class Connection(asyncio.Protocol):
    """One client of a port: hands bytes to its session and answers back.

    Args:
        port: the port that the client came to.
    """

    def __init__(self, port: Port) -> None:
        self._port = port
        self._session = port.new_session()
        self._loop = asyncio.get_running_loop()
        self._transport: asyncio.Transport | None = None
        self._waiting: asyncio.Task[None] | None = None
        self._timers: list[asyncio.TimerHandle] = []
        self._backlog = 0
        self.gone: asyncio.Future[None] = self._loop.create_future()
        port.joined(self)

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        """Start the conversation."""
        if isinstance(transport, asyncio.Transport):
            self._transport = transport
        if self._port.closing:
            self.abort()

    def data_received(self, data: bytes) -> None:
        """Feed the session and let it answer, unless it is still busy with an earlier request."""
        self._session.feed(data)
        if self._waiting is None:
            self._answer()
            return
        self._backlog += len(data)
        if self._backlog > _BACKLOG_BYTES and self._transport is not None:
            self._transport.pause_reading()

    def connection_lost(self, exc: Exception | None) -> None:  # noqa: ARG002 - asyncio's signature
        """End the conversation and whatever waits in it."""
        self._transport = None
        self._cancel_timers()
        self._session.close()
        self._port.left(self)
        if self._waiting is None:
            self.gone.set_result(None)
            return
        self._waiting.add_done_callback(lambda _task: self.gone.set_result(None))
        self._waiting.cancel()

    def abort(self) -> None:
        """Drop the client."""
        if self._transport is not None:
            self._transport.abort()

    def _answer(self) -> None:
        self._cancel_timers()
        answer: Answer | None = self._port.stall() or self._session.answer()
        while answer is not None:
            if isinstance(answer, Pending):
                self._waiting = self._loop.create_task(self._finish(answer))
                return
            self._write(answer)
            answer = self._port.stall() or self._session.answer()
        self._set_timers()

    async def _finish(self, pending: Pending) -> None:
        await self._port.keeper.wait(pending.due)
        self._waiting = None
        self._write(pending.reply())
        self._backlog = 0
        if self._transport is not None:
            self._transport.resume_reading()
            self._answer()

    def _write(self, answer: bytes) -> None:
        if answer and self._transport is not None and not self._port.muted:
            self._transport.write(answer)

    def _set_timers(self) -> None:
        silence_s = self._session.silence_s()
        if silence_s is not None:
            self._timers.append(self._loop.call_later(silence_s, self._idle))
        due_s = self._session.next_output_s()
        if due_s is not None:
            keeper = self._port.keeper
            delay_s = max(0.0, due_s - keeper.bench.time_s) / keeper.speed
            self._timers.append(self._loop.call_later(delay_s, self._output))

    def _cancel_timers(self) -> None:
        for timer in self._timers:
            timer.cancel()
        self._timers.clear()

    def _idle(self) -> None:
        self._session.idle()
        self._answer()

    def _output(self) -> None:
        self._port.keeper.sync()
        self._cancel_timers()
        self._write(self._session.output())
        self._set_timers()


def _address(device: str, endpoint: str) -> tuple[str, int]:
    try:
        parts = urlsplit(endpoint)
        host, port = parts.hostname, parts.port
    except ValueError:
        host, port = None, None
    if not endpoint.startswith("tcp://") or host is None or port is None:
        raise EmulatorError(
            f"{device}: emulators listen on tcp://HOST:PORT only (port 0 takes a free one), not on {endpoint!r}"
        )
    return host, port
