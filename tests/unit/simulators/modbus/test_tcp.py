"""Modbus TCP against the specification's frames and the register map of the sheet `modbus_env`, section 1a."""

import math
import struct
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.simulators.modbus.air_sensor import AirSensor
from catseye.simulators.modbus.exceptions import ILLEGAL_ADDRESS, ModbusError
from catseye.simulators.modbus.tcp import ModbusSession, Registers, respond
from catseye.simulators.world.air import dew_point_c
from catseye.simulators.world.air_probe import AirFault, AirProbe
from catseye.simulators.world.scara.arm import scara_bench
from tests.unit.simulators.benches import QUIET, perfect_arm, quiet_bench, without_j4_play


class Bank(Registers):
    """Registers and coils without a meaning: the addresses 0 to 99."""

    def __init__(self) -> None:
        self.identity = {0: "EMULATOR", 1: "bank", 2: "1", 3: "url"}
        self.words = [0] * 100
        self.bits = [False] * 100

    def read_words(self, address: int, count: int) -> list[int]:
        self._check(address, count)
        return self.words[address : address + count]

    def write_words(self, address: int, words: list[int]) -> None:
        self._check(address, len(words))
        self.words[address : address + len(words)] = words

    def read_bits(self, address: int, count: int) -> list[bool]:
        self._check(address, count)
        return self.bits[address : address + count]

    def read_inputs(self, address: int, count: int) -> list[bool]:
        return [not bit for bit in self.read_bits(address, count)]

    def write_bits(self, address: int, bits: list[bool]) -> None:
        self._check(address, len(bits))
        self.bits[address : address + len(bits)] = bits

    def _check(self, address: int, count: int) -> None:
        if address + count > 100:
            raise ModbusError(ILLEGAL_ADDRESS)


def said(registers: Bank | AirSensor, request: str) -> str:
    return respond(registers, bytes.fromhex(request)).hex(" ")


@pytest.fixture
def bank() -> Bank:
    return Bank()


def test_registers_are_written_and_read(bank: Bank) -> None:
    assert said(bank, "06 0001 00 03") == "06 00 01 00 03"
    assert said(bank, "10 0002 0002 04 000a 0102") == "10 00 02 00 02"
    for function in ("03", "04"):
        assert said(bank, f"{function} 0001 0003") == f"{function} 06 00 03 00 0a 01 02"
    assert said(bank, "17 0001 0002 0003 0001 02 beef") == "17 04 00 03 00 0a"
    assert bank.words[3] == 0xBEEF


def test_coils_are_written_and_read(bank: Bank) -> None:
    assert said(bank, "05 0000 ff00") == "05 00 00 ff 00"
    # Specification, section 6.11: ten coils from 20, CD 01.
    assert said(bank, "0f 0013 000a 02 cd01") == "0f 00 13 00 0a"
    assert bank.bits[19:29] == [True, False, True, True, False, False, True, True, True, False]
    assert said(bank, "01 0013 000a") == "01 02 cd 01"
    assert said(bank, "02 0000 0001") == "02 01 00"  # the bank's inputs are its coils, inverted
    assert said(bank, "05 0000 0000") == "05 00 00 00 00"
    assert bank.bits[0] is False


@pytest.mark.parametrize(
    ("request_", "exception"),
    [
        ("07", "87 01"),
        ("2b 0d 0100", "ab 01"),
        ("03 0063 0002", "83 02"),
        ("03 ffff 0002", "83 02"),
        ("05 0064 ff00", "85 02"),
        ("03 0000 0000", "83 03"),
        ("03 0000 007e", "83 03"),
        ("03 0000", "83 03"),
        ("05 0000 1234", "85 03"),
        ("10 0000 0002 03 000a01", "90 03"),
        ("0f 0000 000a 01 cd", "8f 03"),
        ("10", "90 03"),
        ("2b 0e 05 00", "ab 03"),
        ("2b 0e 04 09", "ab 02"),
    ],
)
def test_wrong_requests_give_their_exception(bank: Bank, request_: str, exception: str) -> None:
    assert said(bank, request_) == exception


def test_identification(bank: Bank) -> None:
    basic = respond(bank, bytes.fromhex("2b0e0100"))
    assert basic == b"\x2b\x0e\x01\x82\x00\x00\x03\x00\x08EMULATOR\x01\x04bank\x02\x011"
    assert respond(bank, bytes.fromhex("2b0e0200")).endswith(b"\x03\x03url")
    assert respond(bank, bytes.fromhex("2b0e0401")) == b"\x2b\x0e\x04\x82\x00\x00\x01\x01\x04bank"
    # A stream that starts at an unknown object starts at the first one.
    assert respond(bank, bytes.fromhex("2b0e0109")) == basic


@pytest.fixture
def probe() -> AirProbe:
    return AirProbe(quiet_bench())


@pytest.fixture
def sensor(probe: AirProbe) -> AirSensor:
    return AirSensor(probe, 0x2C)


def floats(sensor: AirSensor, address: int) -> float:
    """Decode a float: the least significant word comes first."""
    low, high = sensor.read_words(address, 2)
    return float(struct.unpack(">f", struct.pack(">HH", high, low))[0])


def test_the_sensor_gives_floats_with_the_low_word_first(sensor: AirSensor) -> None:
    air = quiet_bench().air()
    assert floats(sensor, 0x0000) == pytest.approx(air.humidity_percent, rel=1e-6)
    assert floats(sensor, 0x0002) == pytest.approx(air.temperature_c, rel=1e-6)
    assert floats(sensor, 0x002C) == pytest.approx(air.pressure_hpa, rel=1e-6)
    assert floats(sensor, 0x0006) == pytest.approx(9.3, abs=0.6)
    assert math.isnan(floats(sensor, 0x0008))


def test_the_word_order_is_that_of_the_sheets_example(sensor: AirSensor, probe: AirProbe) -> None:
    # Sheet, section 1a: 30.56 % = 0x41F47AE1 stands in the registers as 7AE1 41F4.
    air = quiet_bench().air()
    probe.fault = AirFault(humidity_percent=30.56 - air.humidity_percent)
    assert sensor.read_words(0, 2) == [0x7AE1, 0x41F4]


def test_scaled_integers_stand_beside_the_floats(sensor: AirSensor) -> None:
    air = quiet_bench().air()
    words = sensor.read_words(0x0100, 0x20)
    assert words[0] == round(air.humidity_percent * 100.0)
    assert words[1] == round(air.temperature_c * 100.0)
    assert words[0x16] == round(air.pressure_hpa * 10.0)
    assert words[2] == 0x8000


def test_a_negative_temperature_is_in_twos_complement(sensor: AirSensor, probe: AirProbe) -> None:
    air = quiet_bench().air()
    probe.fault = AirFault(temperature_k=-5.0 - air.temperature_c)
    assert sensor.read_words(0x0101, 1) == [0x10000 - 500]


def test_a_sensor_without_values_says_so(sensor: AirSensor, probe: AirProbe) -> None:
    assert sensor.read_words(0x0200, 2) == [1, 1]
    probe.fault = AirFault(missing=True)
    assert math.isnan(floats(sensor, 0x0002))
    # Sheet, section 1a: a quiet NaN; 0x8000 in the integers.
    assert sensor.read_words(0x0002, 2) == [0x0000, 0x7FC0]
    assert sensor.read_words(0x0101, 1) == [0x8000]
    assert sensor.read_words(0x0200, 2) == [0, 0]


def test_measured_values_cannot_be_written_and_settings_can(sensor: AirSensor) -> None:
    assert said(sensor, "06 0002 0001") == "86 02"
    assert said(sensor, "10 0300 0002 04 1234 5678") == "10 03 00 00 02"
    assert said(sensor, "03 0300 0002") == "03 04 12 34 56 78"
    assert said(sensor, "03 0315 0002") == "83 02"
    assert said(sensor, "01 0000 0001") == "81 02"
    assert said(sensor, "05 0000 ff00") == "85 02"
    assert said(sensor, "03 00ff 0002") == "83 02"


def test_the_registers_for_testing_have_the_manuals_values(sensor: AirSensor) -> None:
    assert sensor.read_words(0x1F00, 1) == [-12345 & 0xFFFF]
    assert floats(sensor, 0x1F01) == pytest.approx(-123.45, abs=1e-5)
    text = b"".join(word.to_bytes(2) for word in sensor.read_words(0x1F03, 4))
    assert text == b"-123.45\0"
    with pytest.raises(ModbusError):
        sensor.write_words(0x1F00, [1])


def test_the_identification_goes_on_to_the_calibration(sensor: AirSensor) -> None:
    regular = respond(sensor, bytes.fromhex("2b0e0200"))
    assert (regular[3], regular[6]) == (0x83, 6)
    everything = respond(sensor, bytes.fromhex("2b0e0300"))
    assert everything[6] == 9
    assert b"\x81\x0a2026-01-01" in everything
    assert respond(sensor, bytes.fromhex("2b0e0480"))[7] == 0x80
    assert len(everything) <= 253


def test_it_says_that_it_is_an_emulator(sensor: AirSensor) -> None:
    assert b"EMULATOR" in respond(sensor, bytes.fromhex("2b0e0100"))


def test_another_register_can_have_the_pressure() -> None:
    sensor = AirSensor(AirProbe(quiet_bench()), 0x90)
    assert floats(sensor, 0x90) == pytest.approx(quiet_bench().air().pressure_hpa, rel=1e-6)
    assert math.isnan(floats(sensor, 0x2C))


def test_the_dew_point_is_that_of_the_tables() -> None:
    # 20 °C and 50 %: 9.27 °C; saturated air: its own temperature.
    assert dew_point_c(20.0, 50.0) == pytest.approx(9.27, abs=0.02)
    assert dew_point_c(20.0, 100.0) == pytest.approx(20.0)


def drain(session: ModbusSession) -> bytes:
    out = b""
    while (answer := session.answer()) is not None:
        assert isinstance(answer, bytes)
        out += answer
    return out


FRAMES = bytes.fromhex(
    "0001 0000 0006 01 03 0000 0002 0002 0000 0006 ff 06 0001 0007 0003 0000 0005 00 2b 0e 01 00"
)


@given(st.lists(st.integers(0, len(FRAMES)), max_size=6))
def test_frames_may_be_split_and_joined(cuts: list[int]) -> None:
    whole = ModbusSession(Bank(), lambda _text: None)
    whole.feed(FRAMES)
    expected = drain(whole)
    session = ModbusSession(Bank(), lambda _text: None)
    places = [0, *sorted(cuts), len(FRAMES)]
    got = b""
    for a, b in pairwise(places):
        session.feed(FRAMES[a:b])
        got += drain(session)
    assert got == expected
    assert expected.startswith(
        bytes.fromhex("0001 0000 0007 01 03 04 0000 0000 0002 0000 0006 ff 06 0001 0007")
    )


@given(st.binary(max_size=400))
def test_random_bytes_never_raise(data: bytes) -> None:
    session = ModbusSession(
        AirSensor(AirProbe(scara_bench(perfect_arm(), without_j4_play(QUIET))), 0x2C), lambda _text: None
    )
    session.feed(data)
    out = drain(session)
    # Whatever is answered is a frame that belongs to the protocol.
    assert not out or out[2:4] == b"\x00\x00"


@given(st.binary(min_size=1, max_size=253))
def test_every_request_has_a_reply_of_legal_size(pdu: bytes) -> None:
    reply = respond(Bank(), pdu)
    assert reply[0] in {pdu[0], pdu[0] | 0x80}
    assert 2 <= len(reply) <= 253


def test_after_a_header_that_is_no_modbus_nothing_is_answered() -> None:
    session = ModbusSession(Bank(), lambda _text: None)
    session.feed(bytes.fromhex("0001 dead 0006 01 03 0000 0002"))
    assert drain(session) == b""
    session.feed(FRAMES)
    assert drain(session) == b""


def test_a_mask_changes_single_bits_of_a_setting(sensor: AirSensor) -> None:
    sensor.write_words(0x0300, [0x0012])
    # The example of the Modbus specification V1.1b3, section 6.16: 12, F2 and 25 give 17, all hexadecimal.
    request = bytes.fromhex("16 0300 00f2 0025")
    assert respond(sensor, request) == request
    assert sensor.read_words(0x0300, 1) == [0x0017]


@pytest.mark.parametrize(
    ("request_", "exception"),
    [("16 0000 00f2 0025", "96 02"), ("16 0300 00f2", "96 03"), ("16 0300 00f2 0025 00", "96 03")],
)
def test_a_mask_reaches_settings_only(sensor: AirSensor, request_: str, exception: str) -> None:
    assert said(sensor, request_) == exception


def test_not_all_devices_write_by_masks(bank: Bank, probe: AirProbe) -> None:
    simple = AirSensor(probe, 0x2C, diagnostics=False)
    for device in (bank, simple):
        assert said(device, "16 0300 00f2 0025") == "96 01"


@pytest.mark.parametrize("function", [1, 2, 5, 7, 8, 15, 22, 23])
def test_a_simple_transmitter_has_few_functions(probe: AirProbe, function: int) -> None:
    simple = AirSensor(probe, 0x2C, diagnostics=False)
    assert respond(simple, bytes([function, 0, 0, 0, 1])) == bytes([0x80 | function, 1])
