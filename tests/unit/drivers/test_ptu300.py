"""The PTU300's driver against the manual's lines and scripted sensors."""

import contextlib
import math
from collections.abc import Iterable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.drivers.air.ptu300 import PtuSettings, VaisalaAscii
from catseye.drivers.air.ptu300_codec import TextDecoder, Values, checked, parse_values
from catseye.drivers.roles.errors import LinkError, ProtocolError, WrongDeviceError
from tests.transcripts.vaisala_ptu300 import DEFAULT_LINE, FORMATS, READINGS
from tests.unit.drivers.outcomes import outcome_of
from tests.unit.drivers.peers import Peer, StepClock


def test_the_default_line_of_the_manual() -> None:
    found = parse_values(DEFAULT_LINE)
    assert (found.pressure_hpa, found.temperature_c, found.humidity_percent) == (1013.2, 31.1, 38.3)


@pytest.mark.parametrize("form", FORMATS)
def test_other_formats_of_the_manual(form: str) -> None:
    pressure, temperature, humidity, _ = READINGS[form]
    found = parse_values(FORMATS[form])
    assert found.temperature_c == pytest.approx(temperature)
    assert found.humidity_percent == pytest.approx(humidity)
    assert found.pressure_hpa == (pytest.approx(pressure) if "P=" in form else None)


def test_asterisks_are_no_value() -> None:
    found = parse_values("P=******* hPa T= 21.0 'C RH=***.** %RH")
    assert (found.pressure_hpa, found.temperature_c, found.humidity_percent) == (None, 21.0, None)


@pytest.mark.parametrize(
    ("line", "hpa"),
    [
        ("P= 101.32 kPa", 1013.2),
        ("P= 29.92 inHg", 1013.207),
        ("P=760.0 mmHg", 1013.25),
        ("P=101325 Pa", 1013.25),
    ],
)
def test_units_of_pressure(line: str, hpa: float) -> None:
    assert parse_values(line).pressure_hpa == pytest.approx(hpa, rel=1e-5)


@pytest.mark.parametrize("line", ["P= 1.0 parsec", "T= 20.0 'K", "RH= 40.0 g", "hello", "P 1013.2 hPa"])
def test_lines_that_say_something_else(line: str) -> None:
    with pytest.raises(ProtocolError):
        parse_values(line)


def test_the_checksum_is_the_sum_of_what_stands_before_it() -> None:
    assert checked("P= 1 " + f"{sum(b'P= 1 '):04X}") == "P= 1 "
    for wrong in ("P= 1 0000", "P= 1 ", "P= 1"):
        with pytest.raises(ProtocolError, match="checksum"):
            checked(wrong)


@given(cut=st.integers(1, len(DEFAULT_LINE) + 6))
def test_any_split_gives_the_same_line(cut: int) -> None:
    data = b"SEND\r\n\r\n>" + DEFAULT_LINE.encode() + b"\r\n"
    decoder = TextDecoder("SEND")
    found = decoder.feed(data[:cut]) or decoder.feed(data[cut:])
    assert found == DEFAULT_LINE


NEAR_VALUES = st.text("PTRHhPa C'%=*. -+0123456789einf", max_size=60).map(
    lambda text: text.encode() + b"\r\n"
)


MEASURED = st.one_of(st.floats().map(repr), st.sampled_from(["1e999", "9" * 400])).map(
    lambda value: f"P= {value} hPa T= 21.0 'C RH= {value} %RH\r\n".encode()
)


@given(junk=st.one_of(st.binary(max_size=2000), NEAR_VALUES, MEASURED))
def test_random_bytes_are_finite_values_or_a_protocol_error(junk: bytes) -> None:
    line = outcome_of(TextDecoder("SEND").feed, junk)
    if isinstance(line, str):
        found = outcome_of(parse_values, line)
        values = vars(found).values() if isinstance(found, Values) else ()
        assert all(value is None or math.isfinite(value) for value in values)


class Sensor:
    """A scripted PTU300."""

    def __init__(self, *, takes_format: bool = True, version: str = "PTU300 / 5.16") -> None:
        self.takes_format = takes_format
        self.version = version
        self.own_format = False
        self.line = DEFAULT_LINE
        self.spoil = False

    def __call__(self, data: bytes) -> Iterable[bytes]:
        command = data.decode().strip()
        if command.startswith("FORM"):
            self.own_format = self.takes_format
            return [b"OK\r\n"] if self.takes_format else [b"Error in the format\r\n"]
        if command == "SEND":
            if not self.own_format:
                return [self.line.encode() + b"\r\n"]
            body = f"{self.line} ".encode()
            return [body, f"{sum(body) + self.spoil & 0xFFFF:04X}\r\n".encode()]
        answers = {"VERS": self.version, "SNUM": "Serial number  : X1234567"}
        return [f"{answers[command]}\r\n".encode()] if command in answers else []


async def test_a_sample_in_the_drivers_own_format() -> None:
    sensor = Sensor()
    async with Peer(sensor) as peer:
        air = VaisalaAscii(peer.transport, StepClock(), PtuSettings(timeout_s=0.5))
        identity = await air.connect()
        assert (identity.model, identity.firmware, identity.serial) == ("Vaisala PTU300", "5.16", "X1234567")
        assert not identity.simulated
        sample = await air.sample()
        assert (sample.pressure_hpa, sample.temperature_c, sample.humidity_percent) == (1013.2, 31.1, 38.3)
        assert air.notes == ()
        sensor.spoil = True
        with pytest.raises(ProtocolError, match="checksum"):
            await air.sample()
        sensor.spoil = False
        assert (await air.sample()).pressure_hpa == 1013.2
        await air.close()


@pytest.mark.parametrize(("address", "first"), [(None, b"S\r"), (3, b"OPEN 3\r")])
async def test_a_sensor_of_its_own_is_first_told_to_stop(address: int | None, first: bytes) -> None:
    async with Peer(Sensor()) as peer:
        air = VaisalaAscii(peer.transport, StepClock(), PtuSettings(timeout_s=0.05, address=address))
        with contextlib.suppress(LinkError):
            await air.connect()
        await air.close()
    assert peer.requests[0] == first


async def test_a_sensor_refusing_the_format_is_read_as_is() -> None:
    async with Peer(Sensor(takes_format=False)) as peer:
        air = VaisalaAscii(peer.transport, StepClock(), PtuSettings(timeout_s=0.5))
        await air.connect()
        assert (await air.sample()).humidity_percent == 38.3
        assert "read as they come" in air.notes[0]
        await air.close()


async def test_a_stranger_and_a_silent_line_are_reported() -> None:
    async with Peer(Sensor(version="HELLO")) as peer:
        air = VaisalaAscii(peer.transport, StepClock(), PtuSettings(timeout_s=0.5))
        with pytest.raises(WrongDeviceError, match="no PTU300"):
            await air.connect()
    async with Peer(lambda _data: []) as peer:
        air = VaisalaAscii(peer.transport, StepClock(), PtuSettings(timeout_s=0.05))
        with pytest.raises(LinkError):
            await air.connect()
