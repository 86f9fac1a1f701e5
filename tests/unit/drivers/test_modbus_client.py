"""The Modbus client over the loopback."""

import asyncio

import pytest

from catseye.drivers.links.endpoint import TcpEndpoint
from catseye.drivers.links.inbox import TURN_BYTES
from catseye.drivers.modbus.client import RegisterClient
from catseye.drivers.roles.errors import (
    LinkTimeoutError,
    ProtocolError,
    RefusedError,
    UnreachableError,
    WrongDeviceError,
)
from tests.patience import until
from tests.unit.drivers.modbus_peers import frame, modbus_server, registers_of_the_sheet
from tests.unit.drivers.peers import loopback


async def test_client_reads_registers_and_shows_the_bytes() -> None:
    wire: list[tuple[str, bytes]] = []
    async with modbus_server(registers_of_the_sheet) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), sink=lambda d, b: wire.append((d, b)))
        await client.open()
        assert await client.read(3, 0, 2) == [0x7AE1, 0x41F4]
        assert await client.identify() == {0: "Vaisala", 1: "PTU"}
        with pytest.raises(
            RefusedError, match=r"refused 2 registers from 0x0002.*exception 2, illegal data"
        ) as caught:
            await client.read(4, 2, 2)
        assert caught.value.number == 2
        await client.close()
        await client.close()
    assert wire[0] == ("tx", bytes.fromhex("0001 0000 0006 01 03 0000 0002"))
    assert wire[1] == ("rx", bytes.fromhex("0001 0000 0007 01 03 04 7AE1 41F4"))
    assert [direction for direction, _ in wire] == ["tx", "rx"] * 3


async def test_client_shows_each_byte_once_although_the_answer_is_split() -> None:
    wire: list[bytes] = []
    whole = bytes.fromhex("0001 0000 0007 01 03 04 7AE1 41F4")

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        await reader.read(260)
        writer.write(whole[:5])
        await until(lambda: wire[-1] == whole[:5])
        writer.write(whole[5:])
        await reader.read(260)

    async with loopback(serve) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), sink=lambda _, data: wire.append(data))
        await client.open()
        assert await client.read(3, 0, 2) == [0x7AE1, 0x41F4]
        await client.close()
    assert wire[1:] == [whole[:5], whole[5:]]


async def test_client_that_gets_no_answer_opens_the_link_anew() -> None:
    silent = [True]

    def answer(request: bytes) -> bytes:
        return b"" if silent else registers_of_the_sheet(request)

    async with modbus_server(answer) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), timeout_s=0.2)
        await client.open()
        with pytest.raises(
            LinkTimeoutError, match=rf"tcp://127.0.0.1:{port}: no answer to 2 registers.*no byte came"
        ):
            await client.read(3, 0, 2)
        silent.clear()
        assert await client.read(3, 0, 2) == [0x7AE1, 0x41F4]
        await client.close()


async def test_client_that_gets_other_bytes_names_them() -> None:
    async with modbus_server(lambda _: b"QeR601000000") as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), timeout_s=0.2)
        await client.open()
        with pytest.raises(WrongDeviceError, match=r"no Modbus answer.*QeR601000000"):
            await client.read(3, 0, 2)
        await client.close()


async def test_an_answer_to_an_older_request_is_never_taken() -> None:
    def late(request: bytes) -> bytes:
        stale = (int.from_bytes(request[:2], "big") - 1).to_bytes(2, "big") + request[2:]
        return frame(stale, bytes.fromhex("03 04 FFFF FFFF")) + registers_of_the_sheet(request)

    async with modbus_server(late) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), timeout_s=1.0)
        await client.open()
        await client.identify()
        assert await client.read(3, 0, 2) == [0x7AE1, 0x41F4]
        await client.close()


async def test_a_cancellation_that_comes_with_the_answer_is_not_lost() -> None:
    def cancel(direction: str, _data: bytes) -> None:
        if direction == "rx":
            asking.cancel()

    async with modbus_server(registers_of_the_sheet) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), sink=cancel)
        await client.open()
        asking = asyncio.create_task(client.read(3, 0, 2))
        await asyncio.wait({asking})
        assert asking.cancelled()
        # The next question is answered on a new connection.
        asking = asyncio.create_task(asyncio.sleep(0, []))
        assert await client.read(3, 0, 2) == [0x7AE1, 0x41F4]
        await client.close()


async def test_client_with_too_few_registers_is_a_protocol_error() -> None:
    async with modbus_server(lambda r: frame(r, bytes.fromhex("03 02 7AE1"))) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port))
        await client.open()
        with pytest.raises(ProtocolError, match="1 registers came for 2 registers"):
            await client.read(3, 0, 2)
        await client.close()


def stale(request: bytes) -> bytes:
    """Return the right answer to the request before."""
    return frame(
        (int.from_bytes(request[:2], "big") - 1).to_bytes(2, "big") + request[2:],
        bytes.fromhex("03 04 FFFF FFFF"),
    )


async def test_a_flooding_device_is_closed_and_named() -> None:
    async with modbus_server(lambda request: stale(request) * 10_000) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port))
        await client.open()
        with pytest.raises(
            UnreachableError, match=rf"air sensor at tcp://127.0.0.1:{port}: bytes keep coming"
        ):
            await client.read(3, 0, 2)
        await client.close()


async def test_a_flood_takes_only_its_share_of_a_turn() -> None:
    turn = 0
    taken: dict[int, int] = {}

    def count(direction: str, data: bytes) -> None:
        if direction == "rx":
            taken[turn] = taken.get(turn, 0) + len(data)

    async def others() -> None:
        nonlocal turn
        while True:
            turn += 1
            await asyncio.sleep(0)

    async with modbus_server(lambda request: stale(request) * 10_000) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), sink=count)
        await client.open()
        running = asyncio.create_task(others())
        with pytest.raises(UnreachableError):
            await client.read(3, 0, 2)
        running.cancel()
        await client.close()
    assert len(taken) > 1
    assert max(taken.values()) <= TURN_BYTES
