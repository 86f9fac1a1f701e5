"""What of a bench does not change while it is watched: its devices, its layout, its air rule."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from catseye.app.cell.axes import robot_driver
from catseye.app.cell.bench import system_of
from catseye.app.cell.model import Air, Cell
from catseye.drivers.roles.robot import RobotAbilities
from catseye.procedures.kit.bench import Bench
from catseye.procedures.kit.system import System


@dataclass(frozen=True)
class DeviceFacts:
    """A device as the cell file has it.

    Attributes:
        name: in the cell file.
        endpoint: where it is.
        driver: that talks to it.
        settings: of the driver.
    """

    name: str
    endpoint: str
    driver: str
    settings: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class BenchFacts:
    """A bench as cell file and search have it.

    Attributes:
        cell: name of the cell.
        devices: every one.
        bench: arm, optics, reflectors; aimed, if a search was made.
        override_cap_percent: highest speed override.
        abilities: of the robot's driver.
        air: how a refractive index follows from the air.
        material: name of the sensor of the links' temperature.
    """

    cell: str
    devices: tuple[DeviceFacts, ...]
    bench: Bench
    override_cap_percent: float
    abilities: RobotAbilities
    air: Air
    material: str | None

    @cached_property
    def system(self) -> System:
        """What there is to ask of the bench."""
        return system_of(self.bench)

    def turned(self, turned_deg: float) -> "BenchFacts":
        """Return the facts with what the arm carries mounted turned about the last axis, deg."""
        return replace(self, bench=self.system.turned(turned_deg).bench) if turned_deg else self


def facts_of(cell: Cell, bench: Bench) -> BenchFacts:
    """Return the facts of a cell with a bench that was made of it."""
    devices = [
        DeviceFacts(role, section.endpoint, section.driver, section.settings)
        for role, section in cell.instruments.items()
    ]
    devices += [
        DeviceFacts(device.name, device.endpoint, device.driver, device.settings) for device in cell.device
    ]
    material = None if cell.material is None else cell.material.sensor
    cap_percent = cell.robot.override_cap_percent
    abilities = robot_driver(cell.robot.driver).abilities
    return BenchFacts(cell.name, tuple(devices), bench, cap_percent, abilities, cell.air, material)
