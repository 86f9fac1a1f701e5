"""The emulated bench of a cell file, whatever arm stands on it."""

from pathlib import Path

from catseye.app.cell.bench import optics_of
from catseye.app.cell.model import Cell
from catseye.app.service.emulation import emulated_devices
from catseye.app.service.scara.emulation import emulation_config as scara_emulation_config
from catseye.app.service.serial.emulation import serial_emulation_config
from catseye.simulators.config import EmulationConfig
from catseye.simulators.emulator import load_emulator


def emulation_config(cell: Cell, speed: float, seed: int, truth: Path | None) -> EmulationConfig:
    """Return the emulated bench of a cell file; the robot's emulator says what arm it drives.

    A SCARA whose cell has optics beside the arm, and none that it carries, stands on the bench of serial arms: there
    joints have the drivetrains that small steps show.

    Args:
        cell: what stands on the bench, and where its devices answer.
        speed: bench seconds in one real second.
        seed: of everything random.
        truth: JSON with the true arm; None draws one.

    Raises:
        ConfigError: an endpoint cannot be emulated, or the file with the true arm cannot be read.
    """
    robot = emulated_devices(cell)[0]
    beside = bool(optics_of(cell)) and not cell.reflector
    serial = beside or load_emulator(robot.protocol).arm == "serial"
    make = serial_emulation_config if serial else scara_emulation_config
    return make(cell, speed, seed, truth)
