"""The door over an RTU line whose answers get lost: a single one stops no arm."""

import asyncio
from collections.abc import Callable, Iterable

import pytest

from catseye.app.engine.door_watch import DoorWatch
from catseye.drivers.io.modbus_io import ModbusIo
from tests.unit.drivers.modbus_peers import RtuDevice, flipped, rtu_frame
from tests.unit.drivers.virtual_time import VirtualClock, run

CLOSED, UNKNOWN_FUNCTION = rtu_frame(b"\x02\x01\x01"), rtu_frame(b"\xab\x01")
ASK_DOOR = 2
LATE_S = 0.15

Fault = Callable[[float], Iterable[tuple[float, bytes]]]

FAULTS: dict[str, Fault] = {
    "lost": lambda _: [],
    "garbled": lambda latency_s: [(latency_s, flipped(CLOSED))],
    "late": lambda _: [(LATE_S, CLOSED)],
    "doubled": lambda latency_s: [(latency_s, CLOSED), (latency_s + 0.001, CLOSED)],
}


@pytest.mark.parametrize("latency_s", [0.02, 0.065])
@pytest.mark.parametrize("fault", FAULTS)
def test_a_single_spoilt_answer_is_no_open_door(
    fault: str, latency_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    questions, spoilt, reported = 0, 0, list[str]()

    def answer(request: bytes) -> Iterable[tuple[float, bytes]]:
        nonlocal questions, spoilt
        if request[1] != ASK_DOOR:
            return [(latency_s, UNKNOWN_FUNCTION)]
        questions += 1
        if questions % 10:
            return [(latency_s, CLOSED)]
        spoilt += 1
        return FAULTS[fault](latency_s)

    async def watched() -> None:
        async with RtuDevice(answer, monkeypatch):
            io = ModbusIo.at("serial:///dev/line?baud=9600&parity=E", VirtualClock())
            await io.connect()
            async with DoorWatch(io, VirtualClock(), reported.append).watching(reported.append):
                await asyncio.sleep(12.0)
            await io.close()

    run(watched())
    assert spoilt >= 7
    assert reported == []
