"""A cell with Modbus devices over TCP and RTU, emulated in a process of its own."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from catseye.app.cell.load import load_cell
from catseye.app.cell.scara.template import TEMPLATE
from tests.system.command import Emulated, emulated

_FURTHER = """
[io]
endpoint = "tcp://127.0.0.1:10503"
settings = {{ door_input = 2 }}

[[device]]
name = "air-rtu"
driver = "modbus-air"
endpoint = "serial://{folder}/air?baud=19200&parity=E"
settings = {{ device_id = 7, pressure_address = 44 }}

[[device]]
name = "comet-rtu"
driver = "modbus-air"
endpoint = "serial://{folder}/comet?baud=9600&stopbits=2"
settings = {{ map = "comet_rtu" }}

[[device]]
name = "io-rtu"
driver = "modbus-io"
endpoint = "serial://{folder}/io?baud=115200"

[[device]]
name = "ptu"
driver = "vaisala-ascii"
endpoint = "serial://{folder}/ptu?baud=4800&parity=E&bits=7"
"""


@dataclass(frozen=True)
class ModbusCell:
    """Where the emulated devices are.

    Attributes:
        emulated: the emulator.
        air_port: TCP port of an air sensor with Vaisala's map.
        io_port: TCP port of a block of inputs and outputs, the door at input 2.
        air_line: serial line of the sensor, 19200 8E1, address 7.
        comet_line: of one with Comet's map, 9600 8N2, address 1.
        io_line: of a block, 115200 8N1, address 1.
        ptu_line: of a PTU300, 4800 7E1.
    """

    emulated: Emulated
    air_port: int
    io_port: int
    air_line: str
    comet_line: str
    io_line: str
    ptu_line: str


@contextmanager
def modbus_cell(folder: Path) -> Iterator[ModbusCell]:
    """Emulate the cell at the speed of the clock."""
    with emulated(folder, "--speed", "1", text=TEMPLATE + _FURTHER.format(folder=folder)) as bench:
        cell = load_cell(bench.cell).cell
        endpoints = (cell.instruments["environment"].endpoint, cell.instruments["io"].endpoint)
        ports = [int(endpoint.rpartition(":")[2]) for endpoint in endpoints]
        lines = [str(folder / name) for name in ("air", "comet", "io", "ptu")]
        yield ModbusCell(bench, ports[0], ports[1], *lines)
