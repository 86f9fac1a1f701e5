"""Functions 07 and 08 as Vaisala's manuals describe them (PTU300: M210796EN-G, tables 49 and 50)."""

import pytest

from catseye.simulators.config import EmulatedDevice
from catseye.simulators.modbus.air_sensor import AirSensor
from catseye.simulators.modbus.emulators import air_registers
from catseye.simulators.modbus.rtu import RtuSession
from catseye.simulators.modbus.tcp import ModbusSession, respond
from catseye.simulators.world.air_probe import AirFault, AirProbe
from tests.unit.simulators.benches import quiet_bench
from tests.unit.simulators.modbus.test_rtu import ask, framed
from tests.unit.simulators.modbus.test_tcp import Bank, drain

LISTEN, RESTART, CLEAR = "08 0004 0000", "08 0001 0000", "08 000a 0000"


@pytest.fixture
def probe() -> AirProbe:
    return AirProbe(quiet_bench())


@pytest.fixture
def sensor(probe: AirProbe) -> AirSensor:
    return AirSensor(probe, 0x2C)


def said(sensor: AirSensor, request: str) -> str:
    return respond(sensor, bytes.fromhex(request)).hex(" ")


def counter(sensor: AirSensor, code: int) -> int:
    reply = respond(sensor, bytes([8, 0, code, 0, 0]))
    assert reply[:3] == bytes([8, 0, code])
    return int.from_bytes(reply[3:], "big")


def test_exception_status_sums_up_the_status_registers(sensor: AirSensor, probe: AirProbe) -> None:
    assert said(sensor, "07") == "07 07"
    probe.fault = AirFault(missing=True)
    assert said(sensor, "07") == "07 00"
    assert said(sensor, "07 00") == "87 03"


def test_query_data_come_back(sensor: AirSensor) -> None:
    assert said(sensor, "08 0000 a537") == "08 00 00 a5 37"
    assert said(sensor, "08 0000 a537 0001") == "08 00 00 a5 37 00 01"


@pytest.mark.parametrize(
    ("bit", "low", "high"), [(0, "00 01", "00 00"), (14, "40 00", "00 00"), (17, "00 00", "00 02")]
)
def test_the_diagnostic_register_joins_both_error_words(
    probe: AirProbe, bit: int, low: str, high: str
) -> None:
    sensor = AirSensor(probe, 0x2C, error_bit=bit)
    assert said(sensor, "08 0002 0000") == "08 00 02 00 00"
    probe.fault = AirFault(missing=True)
    assert said(sensor, "03 0203 0002") == f"03 04 {low} {high}"
    assert said(sensor, "08 0002 0000") == f"08 00 02 {low if bit < 16 else high}"


def test_diagnostics_that_are_not_there_are_refused(sensor: AirSensor) -> None:
    assert said(sensor, "08 0003 0000") == "88 01"
    assert said(sensor, "08 0012 0000") == "88 01"
    assert said(sensor, "08 0001 ff00") == "88 03"
    assert said(sensor, "08 000b 0001") == "88 03"
    assert said(sensor, "08 00") == "88 03"


def test_requests_and_exceptions_are_counted_until_cleared(sensor: AirSensor) -> None:
    session = ModbusSession(sensor, lambda _text: None)
    session.feed(bytes.fromhex("0001 0000 0006 01 03 0000 0002 0002 0000 0006 01 03 9000 0002"))
    drain(session)
    assert (counter(sensor, 13), counter(sensor, 14)) == (1, 4)
    session.feed(bytes.fromhex("0003 0000 0006 01 08 000b 0000"))
    assert drain(session).hex(" ").endswith("08 00 0b 00 03")
    assert said(sensor, CLEAR) == "08 00 0a 00 00"
    assert [counter(sensor, code) for code in (11, 12, 13, 15)] == [0, 0, 0, 0]


def test_clearing_leaves_the_diagnostic_register(sensor: AirSensor, probe: AirProbe) -> None:
    probe.fault = AirFault(missing=True)
    said(sensor, CLEAR)
    assert said(sensor, "08 0002 0000") == "08 00 02 00 01"


def test_a_device_that_listens_only_neither_acts_nor_answers(sensor: AirSensor) -> None:
    assert said(sensor, LISTEN) == ""
    assert said(sensor, "06 0300 1234") == ""
    assert said(sensor, "08 0001 ff00") == ""
    assert said(sensor, RESTART) == ""
    assert said(sensor, "03 0300 0001") == "03 02 00 00"


def test_a_tcp_client_gets_no_byte_from_a_listening_device(sensor: AirSensor) -> None:
    session, other = (ModbusSession(sensor, lambda _text: None) for _ in range(2))
    session.feed(bytes.fromhex("0001 0000 0006 01") + bytes.fromhex(LISTEN))
    other.feed(bytes.fromhex("0001 0000 0006 01 03 0000 0002"))
    assert drain(session) + drain(other) == b""


def test_a_restart_clears_the_counters_and_is_answered(sensor: AirSensor) -> None:
    said(sensor, "03 9000 0001")
    assert said(sensor, RESTART) == "08 00 01 00 00"
    assert counter(sensor, 13) == 0


def test_requests_without_answer_are_counted(sensor: AirSensor) -> None:
    session = RtuSession(sensor, 7, lambda _text: None)
    assert ask(session, framed("00 06 0300 0001")) == b""
    assert ask(session, framed("07 08 000f 0000")) == framed("07 08 000f 0001")


def test_a_line_counts_others_messages_and_broken_frames(sensor: AirSensor) -> None:
    session = RtuSession(sensor, 7, lambda _text: None)
    ask(session, framed("08 03 0000 0001"))
    ask(session, b"\x07\x03\x00\x00\x00\x01\x00\x00")
    assert ask(session, framed("07 08 000c 0000")) == framed("07 08 000c 0001")
    assert ask(session, framed("07 08 000b 0000")) == framed("07 08 000b 0003")
    assert ask(session, framed("07 08 000e 0000")) == framed("07 08 000e 0003")


def test_a_tcp_header_that_is_none_counts_as_an_error(sensor: AirSensor) -> None:
    session = ModbusSession(sensor, lambda _text: None)
    session.feed(b"GET / HTTP/1.1\r\n")
    assert drain(session) == b""
    assert counter(sensor, 12) == 1


def test_counters_begin_again_at_zero(sensor: AirSensor) -> None:
    assert sensor.diagnostics
    sensor.diagnostics.messages = 0x1_0005
    assert counter(sensor, 11) == 5


def test_devices_without_diagnostics_do_not_know_the_functions(probe: AirProbe) -> None:
    options = {"diagnostics": False}
    bare = air_registers(probe, EmulatedDevice("air", "modbus-air", "tcp://127.0.0.1:0", options))
    comet = air_registers(
        probe, EmulatedDevice("air", "modbus-air", "tcp://127.0.0.1:0", {"map": "comet_web"})
    )
    for registers in (bare, comet, Bank()):
        assert respond(registers, b"\x07").hex() == "8701"
        assert respond(registers, bytes.fromhex(CLEAR)).hex() == "8801"
