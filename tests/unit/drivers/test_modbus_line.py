"""The Modbus client over an RTU line, in virtual time."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable

import pytest

from drivers.endpoint import SerialEndpoint
from drivers.errors import LinkTimeoutError, ProtocolError, UnreachableError
from drivers.modbus.client import RegisterClient
from tests.unit.drivers.modbus_peers import RtuDevice, TimedAnswer, rtu_frame
from tests.unit.drivers.virtual_time import run

ANSWER_S = 0.1
TWO, FOUR = rtu_frame(bytes.fromhex("03 04 0001 0002")), rtu_frame(bytes.fromhex("03 08 0003 0004 0005 0006"))
ON, OFF = rtu_frame(b"\x02\x01\x01"), rtu_frame(b"\x02\x01\x00")

Work = Callable[[RegisterClient, RtuDevice], Awaitable[None]]
WithClient = Callable[[TimedAnswer, Work], None]


@pytest.fixture
def with_client(monkeypatch: pytest.MonkeyPatch) -> WithClient:
    """Do something with an open client of a device."""

    def do(answer: TimedAnswer, work: Work) -> None:
        async def linked() -> None:
            async with RtuDevice(answer, monkeypatch) as device:
                client = RegisterClient(SerialEndpoint("/dev/line"), answer_timeout_s=ANSWER_S)
                await client.open()
                await work(client, device)
                await client.close()

        run(linked())

    return do


def scripted(*answers: Iterable[tuple[float, bytes]]) -> TimedAnswer:
    """Answer the requests one after the other."""
    left = iter(answers)
    return lambda _: next(left)


def test_a_late_answer_is_left_out(with_client: WithClient) -> None:
    async def work(client: RegisterClient, _device: RtuDevice) -> None:
        with pytest.raises(LinkTimeoutError):
            await client.read_bits(2, 0, 1)
        assert await client.read_bits(2, 0, 1) == [False]

    with_client(scripted([(1.5 * ANSWER_S, ON)], [(0.02, OFF)]), work)


def test_an_answer_long_overdue_delays_nothing(with_client: WithClient) -> None:
    async def work(client: RegisterClient, device: RtuDevice) -> None:
        with pytest.raises(LinkTimeoutError):
            await client.read_bits(2, 0, 1)
        await asyncio.sleep(ANSWER_S)
        asked_s = asyncio.get_running_loop().time()
        await client.read_bits(2, 0, 1)
        sent_s, _ = device.requests[-1]
        assert sent_s - asked_s < ANSWER_S / 2

    with_client(scripted([], [(0.02, OFF)]), work)


def test_a_flood_while_a_late_answer_is_awaited_is_named(with_client: WithClient) -> None:
    async def work(client: RegisterClient, _device: RtuDevice) -> None:
        with pytest.raises(LinkTimeoutError):
            await client.read_bits(2, 0, 1)
        with pytest.raises(UnreachableError, match="bytes keep coming"):
            await client.read_bits(2, 0, 1)

    with_client(scripted([(1.5 * ANSWER_S, b"x" * 70_000)]), work)


def test_the_double_of_a_shorter_answer_is_no_answer(with_client: WithClient) -> None:
    async def work(client: RegisterClient, _device: RtuDevice) -> None:
        assert await client.read(3, 0, 2) == [1, 2]
        assert await client.read(3, 0x2C, 4) == [3, 4, 5, 6]

    doubled = [(0.02, TWO), (0.03, TWO)]
    with_client(scripted(doubled, [(0.04, FOUR)], [(0.04, FOUR)]), work)


def test_an_answer_of_another_length_is_distrusted(with_client: WithClient) -> None:
    sixteen = rtu_frame(b"\x02\x02\xff\xff")

    async def work(client: RegisterClient, _device: RtuDevice) -> None:
        with pytest.raises(ProtocolError, match="8 bits came for 16 bits"):
            await client.read_bits(2, 0, 16)
        assert await client.read_bits(2, 0, 16) == [True] * 16

    with_client(scripted([(0.02, ON), (0.04, ON)], [(0.02, sixteen)]), work)
