"""The emulated laser tracker of the emulated bench, reached through its control port: one JSON object a line."""

import asyncio
import json
from dataclasses import dataclass
from typing import Any, Self

from drivers.clock import Clock
from drivers.endpoint import open_transport
from drivers.errors import LinkError, LinkTimeoutError, ProtocolError, WrongDeviceError
from drivers.readings import Identity
from drivers.record import Sink
from drivers.transport import Transport

_LONGEST_ANSWER_BYTES = 65536


@dataclass(frozen=True)
class TrackerPosition:
    """A position in the tracker's frame.

    Attributes:
        x_mm: position along x.
        y_mm: position along y.
        u_mm: standard uncertainty of each coordinate.
    """

    x_mm: float
    y_mm: float
    u_mm: float


class BenchTracker:
    """Asks the emulated bench where a laser tracker would see the J4 axis.

    Args:
        transport: leads to the control port.
        timeout_s: for an answer, real s.
    """

    def __init__(self, transport: Transport, timeout_s: float = 5.0) -> None:
        self._transport = transport
        self._timeout_s = timeout_s
        self._lock = asyncio.Lock()
        self._bytes = b""

    @classmethod
    def at(cls, endpoint: str, clock: Clock, sink: Sink | None = None) -> Self:  # noqa: ARG003 - shape of all drivers
        """Return a driver for an endpoint; nothing is opened yet.

        Raises:
            LinkError: the endpoint is wrong.
        """
        return cls(open_transport(endpoint, connect_timeout_s=5.0, sink=sink))

    async def connect(self) -> Identity:
        """Open the link and check who answers.

        Raises:
            WrongDeviceError: it is not the control port of an emulated bench.
            LinkError: unreachable or silent.
        """
        await self._transport.open()
        try:
            name = str((await self._ask("identify")).get("name"))
        except ProtocolError as error:
            await self.close()
            raise WrongDeviceError(
                f"{error}; the tracker's endpoint has to be the bench's control port"
            ) from error
        except LinkError:
            await self.close()
            raise
        return Identity(model=name, firmware="", serial="", simulated="EMULATOR" in name)

    async def close(self) -> None:
        """Disconnect; may be called any number of times."""
        await self._transport.close()

    async def locate(self) -> TrackerPosition:
        """Return where the tracker sees the J4 axis now.

        Raises:
            ProtocolError: the answer is no position.
            LinkError: the link is broken or silent.
        """
        answer = await self._ask("tracker")
        try:
            return TrackerPosition(*(float(answer[key]) for key in ("x_mm", "y_mm", "u_mm")))
        except (KeyError, TypeError, ValueError) as error:
            raise ProtocolError(f"{self._transport.endpoint}: no position in {answer!r}") from error

    async def _ask(self, operation: str) -> dict[str, Any]:
        async with self._lock:
            try:
                async with asyncio.timeout(self._timeout_s):
                    await self._transport.write(json.dumps({"op": operation}).encode() + b"\n")
                    return self._parsed(await self._line())
            except TimeoutError as error:
                # A late answer must not meet the next question.
                await self.close()
                raise LinkTimeoutError(
                    f"tracker at {self._transport.endpoint}: no answer to {operation!r} in {self._timeout_s:g} s; "
                    "check that the emulated bench still runs"
                ) from error

    async def _line(self) -> bytes:
        while b"\n" not in self._bytes:
            if len(self._bytes) > _LONGEST_ANSWER_BYTES:
                raise ProtocolError(f"{self._transport.endpoint}: an answer without end")
            self._bytes += await self._transport.read()
        line, _, self._bytes = self._bytes.partition(b"\n")
        return line

    def _parsed(self, line: bytes) -> dict[str, Any]:
        try:
            answer = json.loads(line)
        except ValueError as error:
            raise ProtocolError(f"{self._transport.endpoint}: {line[:60]!r} is no JSON") from error
        if not isinstance(answer, dict) or answer.get("ok") is not True:
            raise ProtocolError(f"{self._transport.endpoint}: the bench refused: {line[:200]!r}")
        return answer
