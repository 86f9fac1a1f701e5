"""Our drivers and pymodbus' own client, unmodified, against the Modbus emulators over TCP and serial lines."""

import asyncio
import os
import tty
from collections.abc import Iterator

import pytest
from pymodbus import FramerType
from pymodbus.client import ModbusSerialClient, ModbusTcpClient
from pymodbus.exceptions import ModbusIOException

from catseye.drivers.air.modbus_air import ModbusAir
from catseye.drivers.air.ptu300 import VaisalaAscii
from catseye.drivers.io.modbus_io import ModbusIo
from catseye.drivers.links.endpoint import SerialEndpoint
from catseye.drivers.modbus.client import RegisterClient
from catseye.drivers.roles.clock import SystemClock
from tests.system.command import catseye
from tests.system.modbus_cell import ModbusCell, modbus_cell


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModbusCell]:
    with modbus_cell(tmp_path_factory.mktemp("modbus")) as running:
        yield running


def floats(client: ModbusTcpClient | ModbusSerialClient, address: int, device_id: int) -> float:
    answer = client.read_holding_registers(address, count=2, device_id=device_id)
    assert not answer.isError()
    value = client.convert_from_registers(answer.registers, client.DATATYPE.FLOAT32, word_order="little")
    assert isinstance(value, float)
    return value


def test_the_librarys_client_over_tcp(cell: ModbusCell) -> None:
    with ModbusTcpClient("127.0.0.1", port=cell.air_port) as client:
        assert floats(client, 0x0002, 1) == pytest.approx(20.0, abs=1.0)
        assert floats(client, 0x002C, 1) == pytest.approx(1013.0, abs=5.0)
        assert client.read_holding_registers(0x4000, count=1, device_id=1).exception_code == 2
        assert client.read_coils(0, count=1, device_id=1).exception_code == 2
        assert client.read_device_information(device_id=1).information[0].startswith(b"EMULATOR")


def test_the_librarys_client_over_a_serial_line(cell: ModbusCell) -> None:
    # Without parity: this client configures the port twice, and a pseudo-terminal refuses a parity the second time.
    with ModbusSerialClient(cell.air_line, framer=FramerType.RTU, baudrate=19200) as client:
        assert floats(client, 0x0000, 7) == pytest.approx(50.0, abs=5.0)
        assert client.read_input_registers(0x4000, count=1, device_id=7).exception_code == 2
    with ModbusSerialClient(cell.comet_line, baudrate=9600, stopbits=2) as client:
        answer = client.read_holding_registers(0x30, count=4, device_id=1)
        assert answer.registers[0] == pytest.approx(200, abs=10)
        assert answer.registers[3] == pytest.approx(10132, abs=50)


def test_the_librarys_client_reads_diagnostics_over_tcp(cell: ModbusCell) -> None:
    with ModbusTcpClient("127.0.0.1", port=cell.air_port, timeout=0.5, retries=0) as client:
        assert client.read_exception_status(device_id=1).status == 0b111
        assert client.diag_query_data(b"\xa5\x37", device_id=1).message == b"\xa5\x37"
        assert client.diag_read_diagnostic_register(device_id=1).message == 0
        assert client.read_holding_registers(0x4000, count=1, device_id=1).exception_code == 2
        assert client.diag_read_bus_exception_error_count(device_id=1).message >= 1
        client.diag_force_listen_only(device_id=1)
        with pytest.raises(ModbusIOException):
            client.read_exception_status(device_id=1)
        with pytest.raises(ModbusIOException):
            client.diag_restart_communication(False, device_id=1)
        assert client.diag_read_bus_exception_error_count(device_id=1).message == 0


def test_the_librarys_client_reads_diagnostics_over_a_line(cell: ModbusCell) -> None:
    with ModbusSerialClient(cell.air_line, framer=FramerType.RTU, baudrate=19200) as client:
        client.diag_clear_counters(device_id=7)
        assert client.read_exception_status(device_id=7).status == 0b111
        counted = client.diag_read_device_message_count(device_id=7).message
        assert counted == client.diag_read_bus_message_count(device_id=7).message - 1 == 2


def test_the_librarys_client_sets_coils_and_reads_the_door(cell: ModbusCell) -> None:
    with ModbusSerialClient(cell.io_line, baudrate=115200) as client:
        assert not client.write_coils(4, [True, False, True], device_id=1).isError()
        assert client.read_coils(4, count=3, device_id=1).bits[:3] == [True, False, True]
        cell.emulated.ask(op="fault", name="door", open=True)
        assert client.read_discrete_inputs(0, count=1, device_id=1).bits[0] is False
        cell.emulated.ask(op="fault", name="door", open=False)
        assert client.read_discrete_inputs(0, count=1, device_id=1).bits[0] is True


async def test_our_drivers_over_serial_lines(cell: ModbusCell) -> None:
    clock = SystemClock(1.0)
    sensors = (
        ModbusAir.at(
            f"serial://{cell.air_line}?baud=19200&parity=E", clock, device_id=7, pressure_address=0x2C
        ),
        ModbusAir.at(f"serial://{cell.comet_line}?baud=9600&stopbits=2", clock, map="comet_rtu"),
        VaisalaAscii.at(f"serial://{cell.ptu_line}?baud=4800&parity=E&bits=7", clock),
    )
    for sensor in sensors:
        identity = await sensor.connect()
        assert identity.simulated, identity
        sample = await sensor.sample()
        assert sample.temperature_c == pytest.approx(20.0, abs=1.0)
        assert sample.pressure_hpa == pytest.approx(1013.25, abs=5.0)
        assert sample.humidity_percent == pytest.approx(50.0, abs=5.0)
        await sensor.close()


async def test_our_driver_of_the_block(cell: ModbusCell) -> None:
    io = ModbusIo.at(f"tcp://127.0.0.1:{cell.io_port}", SystemClock(1.0), door_input=2)
    assert (await io.connect()).simulated
    assert await io.door_closed()
    await io.show("amber")
    assert cell.emulated.ask(op="state")["coils"]["io"][:3] == [False, True, False]
    cell.emulated.ask(op="fault", name="door")
    assert not await io.door_closed()
    cell.emulated.ask(op="fault", name="clear_faults")
    await io.close()


async def test_a_late_serial_answer_is_not_taken_for_the_next() -> None:
    """RTU answers carry no number: two registers of one question look like two of another one."""
    loop = asyncio.get_running_loop()
    master, slave = os.openpty()
    tty.setraw(slave)
    # Read holding registers 0 and 2: the first answer comes late, so that the question is asked again.
    first, second = (bytes.fromhex(text) for text in ("01 03 02 1111 7418", "01 03 02 2222 20fd"))
    answers = iter([(0.3, first), (0.16, first), (0.16, second)])

    def answer() -> None:
        os.read(master, 256)
        delay_s, data = next(answers)
        loop.call_later(delay_s, os.write, master, data)

    loop.add_reader(master, answer)
    air = RegisterClient(SerialEndpoint(os.ttyname(slave)), timeout_s=0.2)
    try:
        await air.open()
        assert await air.read(3, 0, 1) == [0x1111]
        assert await air.read(3, 2, 1) == [0x2222]
    finally:
        await air.close()
        loop.remove_reader(master)
        os.close(master)
        os.close(slave)


def test_nothing_moves_while_the_door_is_open(cell: ModbusCell) -> None:
    bench = cell.emulated
    bench.ask(op="fault", name="door", open=True)
    try:
        examined = catseye("doctor", bench.cell, cwd=bench.cell.parent)
        assert "the door is open: nothing will move" in examined.stdout
        done = catseye("run", "reflector-search", "--cell", bench.cell, cwd=bench.cell.parent)
    finally:
        bench.ask(op="fault", name="clear_faults")
    assert done.returncode == 5, done.stderr
    assert "the door is open: no motion" in done.stderr
    assert not [
        entry for entry in bench.ask(op="log", device="robot")["entries"] if entry["kind"] == "motion"
    ]
    assert bench.ask(op="state")["coils"]["io"][:3] == [False] * 3
