"""mbpoll (Debian, libmodbus) against the Modbus emulators."""

import subprocess
from collections.abc import Iterator

import pytest

from tests.system.modbus_cell import ModbusCell, modbus_cell


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModbusCell]:
    with modbus_cell(tmp_path_factory.mktemp("modbus")) as running:
        yield running


def mbpoll(*arguments: str | int) -> tuple[list[str], str]:
    """Return the values that it reads, and all that it says."""
    done = subprocess.run(
        ["mbpoll", "-1", "-q", *map(str, arguments)], capture_output=True, text=True, timeout=20, check=False
    )
    said = done.stdout + done.stderr
    values = [line.split("\t")[1].strip() for line in done.stdout.splitlines() if line.startswith("[")]
    return values, said


def is_air(values: list[str]) -> bool:
    """Compare humidity and temperature with a laboratory's: they drift."""
    return [float(value) for value in values] == [pytest.approx(50.0, abs=5.0), pytest.approx(20.0, abs=1.0)]


def tcp(port: int) -> list[str | int]:
    return ["-p", port, "127.0.0.1"]


def rtu(line: str, baud: int, parity: str, stopbits: int, unit: int) -> list[str | int]:
    return ["-m", "rtu", "-b", baud, "-P", parity, "-s", stopbits, "-a", unit, line]


def test_floats_over_tcp(cell: ModbusCell) -> None:
    where = tcp(cell.air_port)
    values, said = mbpoll("-t", "4:float", "-r", 1, "-c", 2, *where)
    assert is_air(values), said
    (pressure,), said = mbpoll("-t", "3:float", "-r", 45, *where)
    assert float(pressure) == pytest.approx(1013.0, abs=5.0), said


def test_an_exception_over_tcp(cell: ModbusCell) -> None:
    _, said = mbpoll("-t", 4, "-r", 20_000, *tcp(cell.air_port))
    assert "Illegal data address" in said


def test_registers_over_rtu(cell: ModbusCell) -> None:
    values, said = mbpoll("-t", "4:float", "-r", 1, "-c", 2, *rtu(cell.air_line, 19200, "even", 1, 7))
    assert is_air(values), said
    values, said = mbpoll("-t", 4, "-0", "-r", 0x30, "-c", 2, *rtu(cell.comet_line, 9600, "none", 2, 1))
    assert is_air([str(int(value) / 10) for value in reversed(values)]), said
    _, said = mbpoll("-t", 4, "-r", 20_000, *rtu(cell.air_line, 19200, "even", 1, 7))
    assert "Illegal data address" in said


def test_another_address_is_met_by_silence(cell: ModbusCell) -> None:
    _, said = mbpoll("-t", 4, "-r", 1, "-o", "0.3", *rtu(cell.air_line, 19200, "even", 1, 8))
    assert "timed out" in said


@pytest.mark.parametrize("link", ["tcp", "rtu"])
def test_coils_and_inputs(cell: ModbusCell, link: str) -> None:
    where, door = rtu(cell.io_line, 115200, "none", 1, 1), 0
    if link == "tcp":
        where, door = tcp(cell.io_port), 2
    _, said = mbpoll("-t", 0, "-r", 5, *where, 1, 0, 1)
    assert "Written 3 references" in said
    assert mbpoll("-t", 0, "-r", 5, "-c", 3, *where)[0] == ["1", "0", "1"]
    assert mbpoll("-t", 1, "-0", "-r", door, *where)[0] == ["1"]
    cell.emulated.ask(op="fault", name="door", open=True)
    assert mbpoll("-t", 1, "-0", "-r", door, *where)[0] == ["0"]
    cell.emulated.ask(op="fault", name="clear_faults")


def test_settings_are_written(cell: ModbusCell) -> None:
    where = tcp(cell.air_port)
    _, said = mbpoll("-t", 4, "-r", 771, *where, 4660)
    assert "Written 1 reference" in said
    assert mbpoll("-t", 4, "-r", 771, *where)[0] == ["4660"]
