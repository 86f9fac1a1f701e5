"""Modbus servers in memory: over the loopback, and one that answers as the sheet tells."""

import asyncio
import struct
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager

from tests.unit.drivers.peers import loopback


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
