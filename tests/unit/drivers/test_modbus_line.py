"""The Modbus client over an RTU line, in virtual time."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable

import pytest

from drivers.endpoint import SerialEndpoint
from drivers.errors import LinkTimeoutError, UnreachableError
from drivers.modbus.client import RegisterClient
from tests.unit.drivers.modbus_peers import RtuDevice, TimedAnswer, rtu_frame
from tests.unit.drivers.virtual_time import run

ANSWER_S = 0.1
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
