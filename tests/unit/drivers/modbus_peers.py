"""Modbus servers: over the loopback, one that answers as the sheet says, and one on an RTU line in memory."""

import asyncio
import contextlib
import struct
from collections.abc import Callable, Iterable
from contextlib import AbstractAsyncContextManager

import pytest

from catseye.drivers.roles.errors import LinkError
from catseye.simulators.modbus.rtu import crc16
from tests.unit.drivers.peers import FarEnd, loopback


def modbus_server(answer: Callable[[bytes], bytes]) -> AbstractAsyncContextManager[int]:
    """Answer each request by the bytes that a function makes of it; none keeps silent."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while data := await reader.read(260):
            writer.write(answer(data))

    return loopback(serve)


def frame(request: bytes, pdu: bytes) -> bytes:
    """Return a Modbus TCP frame with the request's number and unit."""
    return request[:2] + b"\0\0" + struct.pack(">H", len(pdu) + 1) + request[6:7] + pdu


def registers_of_the_sheet(request: bytes) -> bytes:
    """Section 1a: 30.56 %RH -> 7AE1 41F4, by function 3 from address 0; everything else is refused."""
    if request[7:] == bytes.fromhex("03 0000 0002"):
        return frame(request, bytes.fromhex("03 04 7AE1 41F4"))
    if request[7:] == bytes.fromhex("2B 0E 01 00"):
        return frame(request, bytes.fromhex("2B 0E 01 01 00 00 02 00 07") + b"Vaisala" + b"\x01\x03PTU")
    return frame(request, bytes([request[7] | 0x80, 2]))


REOPENING_S = 0.01
"""What closing and opening a serial port costs."""

TimedAnswer = Callable[[bytes], Iterable[tuple[float, bytes]]]


class RtuDevice(FarEnd):
    """Plays a device on an RTU line, for a loop with virtual time.

    Args:
        answer: from a request to delays, s, and frames.
        patch: puts the line in place of the serial port of each client made afterwards.
    """

    def __init__(self, answer: TimedAnswer, patch: pytest.MonkeyPatch) -> None:
        super().__init__("serial:///dev/line")
        self.requests: list[tuple[float, bytes]] = []
        self._answer = answer
        opened = self.near.open

        async def open_slowly() -> None:
            await asyncio.sleep(REOPENING_S)
            await opened()

        patch.setattr(self.near, "open", open_slowly)
        patch.setattr("catseye.drivers.modbus.client.open_transport", lambda *_args, **_options: self.near)

    async def _serve(self) -> None:
        loop = asyncio.get_running_loop()
        while True:
            try:
                request = await self.far.read()
            except LinkError:
                continue
            self.requests.append((loop.time(), request))
            for delay_s, data in self._answer(request):
                loop.call_later(delay_s, self._say, data)

    def _say(self, data: bytes) -> None:
        # What comes while the port is closed is lost.
        with contextlib.suppress(LinkError):
            self.far.send_urgent(data)


def rtu_frame(pdu: bytes) -> bytes:
    """Return the RTU frame of unit 1."""
    return b"\x01" + pdu + crc16(b"\x01" + pdu)


def flipped(data: bytes) -> bytes:
    """Return a frame with one bit of its first byte flipped."""
    return bytes([data[0] ^ 0x80]) + data[1:]
