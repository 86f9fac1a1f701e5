"""Modbus RTU against the specification's frames, and sensors that are described point by point."""

import struct
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.simulators.config import EmulatedDevice, Option
from catseye.simulators.errors import EmulatorError
from catseye.simulators.modbus.emulators import ModbusAir, air_registers
from catseye.simulators.modbus.exceptions import ModbusError
from catseye.simulators.modbus.rtu import RtuSession, crc16
from catseye.simulators.world.air import AirSample
from catseye.simulators.world.air_probe import AirFault, AirProbe
from tests.unit.simulators.benches import quiet_bench
from tests.unit.simulators.modbus.test_tcp import Bank


def probe() -> AirProbe:
    return AirProbe(quiet_bench())


class FixedAir(AirProbe):
    """Always the same air."""

    def __init__(self) -> None:
        super().__init__(quiet_bench())

    def sample(self) -> AirSample | None:
        return AirSample(20.0, 1013.25, 50.0)


def ask(session: RtuSession, *parts: bytes) -> bytes | None:
    for part in parts:
        session.feed(part)
    if session.silence_s() is not None:
        session.idle()
    answer = session.answer()
    assert answer is None or isinstance(answer, bytes)
    return answer


def framed(body: str) -> bytes:
    data = bytes.fromhex(body)
    return data + crc16(data)


@pytest.mark.parametrize(
    ("body", "check"), [("01 03 00 00 00 0A", "C5 CD"), ("01 04 02 FF FF", "B8 80"), ("02 07", "41 12")]
)
def test_the_check_bytes_of_published_frames(body: str, check: str) -> None:
    assert crc16(bytes.fromhex(body)) == bytes.fromhex(check)


def test_a_request_is_answered_after_silence() -> None:
    bank = Bank()
    bank.words[1] = 0x0102
    session = RtuSession(bank, 7, lambda _text: None)
    request = framed("07 03 0001 0001")
    session.feed(request[:3])
    session.feed(request[3:])
    assert session.answer() is None
    assert ask(session) == framed("07 03 02 0102")
    assert session.silence_s() is None


@pytest.mark.parametrize(
    "request_bytes",
    [
        framed("08 03 0001 0001"),
        b"\x07\x03\x00\x01\x00\x01\x00\x00",
        b"\x07\x03",
        b"\xff" * 300,
        b"\r\nhello\r\n",
    ],
    ids=["another address", "wrong check", "too short", "too long", "text"],
)
def test_what_is_not_for_it_is_answered_by_silence(request_bytes: bytes) -> None:
    session = RtuSession(Bank(), 7, lambda _text: None)
    assert not ask(session, request_bytes)
    assert ask(session, framed("07 03 0001 0001")) == framed("07 03 02 0000")


def test_a_broadcast_is_carried_out_and_not_answered() -> None:
    bank = Bank()
    session = RtuSession(bank, 7, lambda _text: None)
    assert ask(session, framed("00 06 0001 0003")) == b""
    assert bank.words[1] == 3


def test_an_exception_has_the_highest_bit_of_the_function_set() -> None:
    assert ask(RtuSession(Bank(), 1, lambda _text: None), framed("01 03 00FF 0001")) == framed("01 83 02")


@given(junk=st.binary(max_size=600))
def test_random_bytes_leave_it_working(junk: bytes) -> None:
    session = RtuSession(Bank(), 1, lambda _text: None)
    ask(session, junk)
    assert ask(session, framed("01 03 0001 0001")) == framed("01 03 02 0000")


def test_a_comet_computes_the_moisture_of_the_air() -> None:
    comet = air_registers(FixedAir(), EmulatedDevice("air", "modbus-air", options={"map": "comet_web"}))
    # At 20 °C, 50 %RH and 1013.25 hPa: tables of moist air.
    assert comet.read_words(0x36, 4) == pytest.approx([86, 72, 73, 385], abs=1)


@pytest.mark.parametrize(("kind", "first"), [("comet_web", 0x31), ("comet_rtu", 0x30)])
def test_a_comet_gives_tenths_from_its_base(kind: str, first: int) -> None:
    """Sheet, section 2: 0x31 T, 0x32 RH, 0x34 pressure in hPa, all times 10; RTU documents send 0x31 as 0x30."""
    here = probe()
    air = here.sample()
    assert air is not None
    registers = air_registers(here, EmulatedDevice("air", "modbus-air", options={"map": kind}))
    words = registers.read_words(first, 4)
    assert words[:2] == [round(10 * air.temperature_c), round(10 * air.humidity_percent)]
    assert words[3] == round(10 * air.pressure_hpa)
    with pytest.raises(ModbusError):
        registers.read_words(first - 1, 1)
    here.fault = AirFault(missing=True)
    assert registers.read_words(first, 1) == [0x8000]


@pytest.mark.parametrize(
    ("options", "most"),
    [({"map": "comet_web"}, 2), ({"map": "comet_web", "clients": 0}, None), ({"clients": 1}, 1), ({}, None)],
)
def test_a_web_sensor_has_two_clients(options: dict[str, Option], most: int | None) -> None:
    assert ModbusAir.most_clients(EmulatedDevice("air", "modbus-air", options=options)) == most


def test_a_cell_file_register_map_is_emulated() -> None:
    here = probe()
    air = here.sample()
    assert air is not None
    points: list[dict[str, Any]] = [
        {"name": "temperature", "address": 1, "type": "uint16", "scale": 0.01, "offset": -273.15},
        {"name": "pressure", "address": 11},
    ]
    options: dict[str, Option] = {
        "map": "generic",
        "points": points,
        "address_base": 1,
        "word_order": "little",
    }
    registers = air_registers(here, EmulatedDevice("air", "modbus-air", options=options))
    assert registers.read_words(0, 1) == [round(100 * (air.temperature_c + 273.15))]
    low, high = registers.read_words(10, 2)
    assert struct.unpack(">f", struct.pack(">HH", high, low))[0] == pytest.approx(air.pressure_hpa, rel=1e-6)


@pytest.mark.parametrize("points", [[], "no list", [{"name": "wind", "address": 1}], [{"name": "pressure"}]])
def test_a_map_that_cannot_be_emulated_is_refused(points: list[dict[str, Any]] | str) -> None:
    device = EmulatedDevice("air", "modbus-air", options={"map": "generic", "points": points})
    with pytest.raises(EmulatorError, match="points"):
        air_registers(probe(), device)
