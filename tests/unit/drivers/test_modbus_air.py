"""The air sensor driver over scripted registers, and over the loopback."""

import struct
from typing import Any
from unittest.mock import patch

import pytest

from catseye.drivers.air.maps import AirSettings, resolve
from catseye.drivers.air.modbus_air import ModbusAir
from catseye.drivers.roles.errors import LinkError, ProtocolError, RefusedError
from tests.unit.drivers.modbus_peers import modbus_server, registers_of_the_sheet
from tests.unit.drivers.peers import StepClock


def cdab(value: float) -> list[int]:
    """Return a float in two registers, less significant word first (sheet, section 1a)."""
    high, low = struct.unpack(">HH", struct.pack(">f", value))
    return [low, high]


class Sensor:
    """Registers in memory; a gap between them can be made unreadable."""

    endpoint = "tcp://sensor:502"

    def __init__(self, registers: dict[int, list[int]], *, gaps: bool = True) -> None:
        self.words = {start + i: word for start, words in registers.items() for i, word in enumerate(words)}
        self.gaps = gaps
        self.reads: list[tuple[int, int, int]] = []
        self.names: dict[int, str] = {0: "Vaisala", 1: "PTU300", 2: "5.16", 0x80: "N0410023"}
        self.is_open = False

    async def open(self) -> None:
        self.is_open = True

    async def close(self) -> None:
        self.is_open = False

    async def read(self, function: int, address: int, count: int) -> list[int]:
        self.reads.append((function, address, count))
        wanted = range(address, address + count)
        if not self.gaps and any(a not in self.words for a in wanted):
            raise RefusedError("exception 2", 2)
        return [self.words.get(a, 0) for a in wanted]

    async def identify(self) -> dict[int, str]:
        if not self.names:
            raise RefusedError("exception 1", 1)
        return self.names


def vaisala(sensor: Sensor, **settings: Any) -> ModbusAir:
    return ModbusAir(sensor, StepClock(), resolve(AirSettings.model_validate(settings)))


AIR = {0x0000: cdab(45.5), 0x0002: cdab(20.25), 0x002C: cdab(1013.25)}


async def test_a_sample_is_one_request() -> None:
    sensor = Sensor(AIR)
    air = vaisala(sensor, pressure_address=0x2C)
    sample = await air.sample()
    assert (sample.temperature_c, sample.pressure_hpa, sample.humidity_percent) == (20.25, 1013.25, 45.5)
    assert sample.time_s == 100.0
    assert sensor.reads == [(3, 0, 0x2E)]
    assert air.notes == ()


async def test_a_quantity_without_register_is_none_and_reported() -> None:
    air = vaisala(Sensor(AIR))
    sample = await air.sample()
    assert (sample.temperature_c, sample.pressure_hpa) == (20.25, None)
    assert "pressure_address" in air.notes[0]
    assert "guess" in air.notes[0]
    other = vaisala(
        Sensor(AIR), map="generic", word_order="little", points=[{"name": "temperature", "address": 2}]
    )
    assert other.notes == ("not measured: pressure, humidity",)


async def test_nan_is_none_for_that_quantity_only() -> None:
    """Sheet, section 1a: missing float = quiet NaN."""
    sample = await vaisala(Sensor(AIR | {0x0000: [0x0000, 0x7FC0]})).sample()
    assert (sample.temperature_c, sample.humidity_percent) == (20.25, None)


async def test_a_sensor_refusing_gaps_is_read_one_by_one() -> None:
    sensor = Sensor(AIR, gaps=False)
    air = vaisala(sensor, pressure_address=0x2C)
    assert (await air.sample()).pressure_hpa == 1013.25
    assert (await air.sample()).humidity_percent == 45.5
    assert sensor.reads == [(3, 0, 0x2E), *[(3, 2, 2), (3, 0x2C, 2), (3, 0, 2)] * 2]


async def test_registers_far_apart_are_read_one_by_one() -> None:
    sensor = Sensor({0x0000: cdab(45.5), 0x0002: cdab(20.25), 0x0800: cdab(990.0)})
    assert (await vaisala(sensor, pressure_address=0x0800).sample()).pressure_hpa == 990.0
    assert len(sensor.reads) == 3


async def test_another_refusal_is_reported() -> None:
    sensor = Sensor({}, gaps=False)
    with pytest.raises(RefusedError):
        await vaisala(sensor).sample()


async def test_a_garbled_value_is_asked_for_again() -> None:
    """Modbus TCP has no check sum of its own: pressure with a flipped bit (proxy campaign)."""
    sensor = Sensor(AIR)
    readings = iter([AIR | {0x002C: cdab(2026.5)}, AIR])

    async def read(function: int, address: int, count: int) -> list[int]:
        return await Sensor(next(readings)).read(function, address, count)

    air = vaisala(sensor, pressure_address=0x2C)
    with patch.object(sensor, "read", read):
        assert (await air.sample()).pressure_hpa == 1013.25


async def test_a_garbled_request_is_sent_again() -> None:
    sensor = Sensor(AIR)
    refusals = iter([RefusedError("exception 1", 1)])

    async def read(function: int, address: int, count: int) -> list[int]:
        for refusal in refusals:
            raise refusal
        return await Sensor(AIR).read(function, address, count)

    air = vaisala(sensor, pressure_address=0x2C)
    with patch.object(sensor, "read", read):
        assert (await air.sample()).pressure_hpa == 1013.25


async def test_implausible_air_names_endpoint_register_and_remedy() -> None:
    with pytest.raises(
        ProtocolError, match=r"air sensor at tcp://sensor:502: temperature .*0x0002.*word_order"
    ):
        await vaisala(Sensor(AIR), word_order="big").sample()


async def test_connecting_returns_the_identity() -> None:
    """Sheet, section 1a: 43/14 gives vendor, model, version and, at 0x80, the serial number."""
    sensor = Sensor(AIR)
    air = vaisala(sensor)
    identity = await air.connect()
    assert (identity.model, identity.firmware, identity.serial) == ("Vaisala PTU300", "5.16", "N0410023")
    assert not identity.simulated
    await air.close()
    assert not sensor.is_open


async def test_an_emulator_is_recognised_by_its_vendor() -> None:
    sensor = Sensor(AIR)
    sensor.names = {0: "catseye emulator", 1: "PTU300"}
    assert (await vaisala(sensor).connect()).simulated


async def test_a_sensor_without_identification_is_named_by_its_map() -> None:
    sensor = Sensor(AIR)
    sensor.names = {}
    identity = await vaisala(sensor).connect()
    assert (identity.model, identity.simulated) == ("Vaisala sensor", False)


async def test_connecting_to_implausible_air_closes_the_link() -> None:
    sensor = Sensor(AIR)
    with pytest.raises(ProtocolError):
        await vaisala(sensor, word_order="big").connect()
    assert not sensor.is_open


async def test_driver_at_an_endpoint_where_nobody_listens() -> None:
    async with modbus_server(registers_of_the_sheet) as port:
        pass
    air = ModbusAir.at(f"tcp://127.0.0.1:{port}", StepClock(), timeout_s=0.5)
    with pytest.raises(LinkError, match=rf"tcp://127.0.0.1:{port}: cannot connect"):
        await air.connect()
    with pytest.raises(LinkError, match="datagrams"):
        ModbusAir.at("udp://127.0.0.1:502", StepClock())


async def test_driver_over_the_loopback() -> None:
    async with modbus_server(registers_of_the_sheet) as port:
        air = ModbusAir.at(
            f"tcp://127.0.0.1:{port}",
            StepClock(),
            map="generic",
            points=[{"name": "humidity", "address": 0}],
            word_order="little",
        )
        identity = await air.connect()
        assert identity.model == "Vaisala PTU"
        sample = await air.sample()
        assert sample.humidity_percent == pytest.approx(30.56, abs=1e-5)
        assert (sample.temperature_c, sample.pressure_hpa) == (None, None)
        await air.close()
