"""Public Modbus libraries of Python and Node.js against the emulated sensor and the emulated inputs and outputs."""

import struct
from collections.abc import Iterator
from typing import Any

import pytest

from tests.peers.environment import NODE_MODULES, said_by, said_by_node
from tests.system.modbus_cell import ModbusCell, modbus_cell

TCP = (
    "pymodbus",
    "modbus_tk",
    "umodbus",
    "async_modbus",
    "pymodbustcp",
    "easymodbus",
    "modbuslink",
    "modbus_rs",
    "pylibmodbus",
    "libmodbuspy",
)
RTU = (
    "pymodbus",
    "minimalmodbus",
    "modbus_tk",
    "umodbus",
    "async_modbus",
    "modbuslink",
    "modbus_rs",
    "pylibmodbus",
    "libmodbuspy",
)
WITHOUT_BITS = {"libmodbuspy"}
"""What they return for coils and inputs is empty, whoever answers them."""

with_node = pytest.mark.skipif(not NODE_MODULES.is_dir(), reason="make peers has found no npm")

DOOR_CLOSED = {"tcp": [0, 0, 1], "rtu": [1, 0, 0]}


@pytest.fixture(scope="module")
def cell(tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModbusCell]:
    with modbus_cell(tmp_path_factory.mktemp("modbus")) as running:
        yield running


def decoded(words: list[int]) -> tuple[float, ...]:
    """Return the floats of Vaisala's map: the less significant word is the first."""
    swapped = [words[n ^ 1] for n in range(len(words))]
    return struct.unpack(f">{len(words) // 2}f", struct.pack(f">{len(words)}H", *swapped))


def check_sensor(said: dict[str, Any]) -> None:
    """Compare what was read from the sensor, whose air drifts, and written to it."""
    humidity, temperature_c = decoded(said["holding"])
    assert humidity == pytest.approx(50.0, abs=5.0)
    assert temperature_c == pytest.approx(20.0, abs=1.0)
    assert decoded(said["input"]) == pytest.approx((humidity, temperature_c), abs=0.05)
    assert [value / 100 for value in said["integers"]] == pytest.approx([humidity, temperature_c], abs=0.05)
    assert said["status"] == [1, 1]
    assert said["written"] == [0x1234]
    assert said["both_written"] == [0, 0x447D]


def check_refusal(said: str) -> None:
    """Look for exception 2 in any of the libraries' words."""
    words = said.lower()
    assert any(word in words for word in ("illegaldata", "illegal data address", "2", "starting address")), (
        said
    )


def check_block(said: dict[str, Any], link: str) -> None:
    """Compare what was written to the coils, and the door's input."""
    assert said["one"] == [1, 0, 0]
    assert said["together"] == [1, 0, 1]
    assert said["inputs"] == DOOR_CLOSED[link]


def check(said: dict[str, Any], link: str, *, bits: bool = True) -> None:
    """Compare all that a library did."""
    check_sensor(said)
    check_refusal(said["refused"])
    if bits:
        check_block(said, link)


@pytest.mark.parametrize("library", TCP)
def test_python_libraries_over_tcp(cell: ModbusCell, library: str) -> None:
    said = said_by("modbus_calls.py", f"{library}_calls", "tcp", str(cell.air_port), str(cell.io_port))
    check(said, "tcp", bits=library not in WITHOUT_BITS)


@pytest.mark.parametrize("library", RTU)
def test_python_libraries_over_rtu(cell: ModbusCell, library: str) -> None:
    said = said_by("modbus_calls.py", f"{library}_calls", "rtu", cell.air_line, cell.io_line)
    check(said, "rtu", bits=library not in WITHOUT_BITS)


@with_node
@pytest.mark.parametrize("library", ["modbus-serial", "jsmodbus"])
def test_node_libraries_over_tcp(cell: ModbusCell, library: str) -> None:
    check(said_by_node("modbus_calls.js", library, "tcp", str(cell.air_port), str(cell.io_port)), "tcp")


@with_node
@pytest.mark.parametrize("library", ["modbus-serial", "jsmodbus"])
def test_node_libraries_over_rtu(cell: ModbusCell, library: str) -> None:
    check(said_by_node("modbus_calls.js", library, "rtu", cell.air_line, cell.io_line), "rtu")


def test_a_client_with_a_wrong_length_is_refused(cell: ModbusCell) -> None:
    # The length in its header leaves out the unit; what it reads then is the exception "illegal data value".
    said = said_by("modbus_wrong_length.py", str(cell.air_port))
    assert said == {"read": None, "read_again": None}


def test_the_command_of_modbus_cli(cell: ModbusCell) -> None:
    said = said_by("modbus_command.py", str(cell.air_port), cell.comet_line)
    humidity, temperature_c = said["floats"]
    assert (humidity, temperature_c) == (pytest.approx(50.0, abs=5.0), pytest.approx(20.0, abs=1.0))
    assert said["comet_c"] == pytest.approx(20.0, abs=1.0)
