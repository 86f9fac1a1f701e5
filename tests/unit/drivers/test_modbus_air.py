"""The air sensor driver over scripted registers, and its client over the loopback."""

import asyncio
import struct
from collections.abc import Callable
from contextlib import AbstractAsyncContextManager
from typing import Any

import pytest

from drivers.air.client import RegisterClient
from drivers.air.maps import AirSettings, resolve
from drivers.air.modbus_air import ModbusAir
from drivers.endpoint import TcpEndpoint
from drivers.errors import LinkError, LinkTimeoutError, ProtocolError, RefusedError, WrongDeviceError
from tests.unit.drivers.peers import StepClock, loopback, until


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


async def test_a_quantity_without_register_is_none_and_told() -> None:
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


async def test_a_sensor_that_does_not_let_one_read_across_gaps_is_read_one_by_one() -> None:
    sensor = Sensor(AIR, gaps=False)
    air = vaisala(sensor, pressure_address=0x2C)
    assert (await air.sample()).pressure_hpa == 1013.25
    assert (await air.sample()).humidity_percent == 45.5
    assert sensor.reads == [(3, 0, 0x2E), *[(3, 2, 2), (3, 0x2C, 2), (3, 0, 2)] * 2]


async def test_registers_far_apart_are_read_one_by_one() -> None:
    sensor = Sensor({0x0000: cdab(45.5), 0x0002: cdab(20.25), 0x0800: cdab(990.0)})
    assert (await vaisala(sensor, pressure_address=0x0800).sample()).pressure_hpa == 990.0
    assert len(sensor.reads) == 3


async def test_another_refusal_is_told() -> None:
    sensor = Sensor({}, gaps=False)
    with pytest.raises(RefusedError):
        await vaisala(sensor).sample()


async def test_implausible_air_names_endpoint_register_and_remedy() -> None:
    with pytest.raises(
        ProtocolError, match=r"air sensor at tcp://sensor:502: temperature .*0x0002.*word_order"
    ):
        await vaisala(Sensor(AIR), word_order="big").sample()


async def test_connecting_tells_who_is_there() -> None:
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


def modbus_server(answer: Callable[[bytes], bytes]) -> AbstractAsyncContextManager[int]:
    """Answer each request by the bytes that a function makes of it; none keeps silent."""

    async def serve(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        while data := await reader.read(260):
            writer.write(answer(data))

    return loopback(serve)


def frame(request: bytes, pdu: bytes) -> bytes:
    """Return a Modbus TCP frame with the request's number and unit."""
    return request[:2] + b"\0\0" + struct.pack(">H", len(pdu) + 1) + request[6:7] + pdu


def registers_of_the_sheet(request: bytes) -> bytes:
    """Section 1a: 30.56 %RH -> 7AE1 41F4, by function 3 from address 0; everything else is refused."""
    if request[7:] == bytes.fromhex("03 0000 0002"):
        return frame(request, bytes.fromhex("03 04 7AE1 41F4"))
    if request[7:] == bytes.fromhex("2B 0E 01 00"):
        return frame(request, bytes.fromhex("2B 0E 01 01 00 00 02 00 07") + b"Vaisala" + b"\x01\x03PTU")
    return frame(request, bytes([request[7] | 0x80, 2]))


async def test_client_reads_registers_and_shows_the_bytes() -> None:
    wire: list[tuple[str, bytes]] = []
    async with modbus_server(registers_of_the_sheet) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), sink=lambda d, b: wire.append((d, b)))
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
        assert await client.read(3, 0, 2) == [0x7AE1, 0x41F4]
        await client.close()
    assert wire[1:] == [whole[:5], whole[5:]]


async def test_client_that_gets_no_answer_opens_the_link_anew() -> None:
    silent = [True]

    def answer(request: bytes) -> bytes:
        return b"" if silent else registers_of_the_sheet(request)

    async with modbus_server(answer) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), timeout_s=0.2)
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
        with pytest.raises(WrongDeviceError, match=r"no Modbus answer.*QeR601000000"):
            await client.read(3, 0, 2)
        await client.close()


async def test_an_answer_to_an_older_request_is_never_taken() -> None:
    def late(request: bytes) -> bytes:
        stale = (int.from_bytes(request[:2], "big") - 1).to_bytes(2, "big") + request[2:]
        return frame(stale, bytes.fromhex("03 04 FFFF FFFF")) + registers_of_the_sheet(request)

    async with modbus_server(late) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), timeout_s=1.0)
        await client.identify()
        assert await client.read(3, 0, 2) == [0x7AE1, 0x41F4]
        await client.close()


async def test_a_cancellation_that_comes_with_the_answer_is_not_lost() -> None:
    def cancel(direction: str, _data: bytes) -> None:
        if direction == "rx":
            asking.cancel()

    async with modbus_server(registers_of_the_sheet) as port:
        client = RegisterClient(TcpEndpoint("127.0.0.1", port), sink=cancel)
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
        with pytest.raises(ProtocolError, match="1 registers came for 2 registers"):
            await client.read(3, 0, 2)
        await client.close()


async def test_driver_at_an_endpoint_where_nobody_listens() -> None:
    async with modbus_server(registers_of_the_sheet) as port:
        pass
    air = ModbusAir.at(f"tcp://127.0.0.1:{port}", StepClock(), timeout_s=0.5)
    with pytest.raises(LinkError, match=rf"air sensor at tcp://127.0.0.1:{port}: cannot connect.*port \(502"):
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
