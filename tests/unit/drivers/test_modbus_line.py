"""The Modbus client over an RTU line, in virtual time."""

import asyncio
from collections.abc import Awaitable, Callable, Iterable
from itertools import pairwise

import pytest

from catseye.drivers.io.modbus_io import ModbusIo
from catseye.drivers.links.endpoint import SerialEndpoint
from catseye.drivers.modbus.client import RegisterClient
from catseye.drivers.roles.errors import LinkTimeoutError, ProtocolError, UnreachableError, WrongDeviceError
from tests.unit.drivers.modbus_peers import RtuDevice, TimedAnswer, flipped, rtu_frame
from tests.unit.drivers.virtual_time import VirtualClock, run

ANSWER_S = 0.1
TWO, FOUR = rtu_frame(bytes.fromhex("03 04 0001 0002")), rtu_frame(bytes.fromhex("03 08 0003 0004 0005 0006"))
NAMES = rtu_frame(bytes.fromhex("2B 0E 01 01 00 00 01 00 05") + b"block")
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


@pytest.mark.parametrize(
    ("endpoint", "silence_s"),
    [
        # 3.5 characters of 11, 12 and 10 bits; above 19 200 Bd the specification fixes 1.75 ms.
        (SerialEndpoint("/dev/line", 9600, "E", "1"), 0.004010),
        (SerialEndpoint("/dev/line", 1200, "E", "2"), 0.035000),
        (SerialEndpoint("/dev/line", 19200, "N", "1"), 0.001823),
        (SerialEndpoint("/dev/line", 115200, "N", "1"), 0.001750),
    ],
    ids=str,
)
def test_silence_divides_a_request_from_the_answer_before(
    endpoint: SerialEndpoint, silence_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def asked() -> None:
        async with RtuDevice(lambda _: [(0.02, ON)], monkeypatch) as device:
            client = RegisterClient(endpoint, answer_timeout_s=ANSWER_S)
            await client.open()
            for _ in range(3):
                await client.read_bits(2, 0, 1)
            await client.close()
        sent_s = [at_s for at_s, _ in device.requests]
        assert [late - early - 0.02 for early, late in pairwise(sent_s)] == pytest.approx(
            [silence_s] * 2, abs=1e-6
        )

    run(asked())


def test_the_double_within_the_silence_is_no_answer(with_client: WithClient) -> None:
    async def work(client: RegisterClient, _device: RtuDevice) -> None:
        assert await client.read_bits(2, 0, 1) == [True]
        assert await client.read_bits(2, 0, 1) == [False]

    with_client(scripted([(0.02, ON), (0.021, ON)], [(0.02, OFF)]), work)


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


@pytest.mark.parametrize(
    "answers",
    [[flipped(NAMES), NAMES, ON], [NAMES, flipped(ON), ON], [NAMES, b"", ON]],
    ids=["name garbled", "door garbled", "door lost"],
)
def test_one_spoilt_answer_prevents_no_connecting(
    answers: list[bytes], monkeypatch: pytest.MonkeyPatch
) -> None:
    async def connected() -> None:
        async with RtuDevice(scripted(*([(0.02, data)] for data in answers)), monkeypatch):
            io = ModbusIo.at("serial:///dev/line", VirtualClock())
            assert (await io.connect()).model == "block"
            await io.close()

    run(connected())


def test_who_answers_garbage_twice_is_a_stranger(with_client: WithClient) -> None:
    async def work(client: RegisterClient, _device: RtuDevice) -> None:
        with pytest.raises(WrongDeviceError, match="baud, parity and stopbits"):
            await client.identify()

    with_client(scripted([(0.02, b"QeR601000000")], [(0.02, b"QeR601000000")]), work)
