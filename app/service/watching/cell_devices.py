"""The devices of a cell file for the bench between runs: those of a run, and the further ones."""

from typing import Any

from catseye.app.cell.model import Cell
from catseye.app.engine.devices import WireRecorder
from catseye.app.engine.instruments import device_builder, further_device
from catseye.app.service.watching.device_pool import CellDevices
from catseye.app.service.watching.latest_values import LatestValues
from catseye.app.service.watching.observed_devices import (
    ObservedController,
    ObservedDevice,
    ObservedSensor,
    observed,
)
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Role
from catseye.drivers.roles.registry import load_driver


def cell_devices(cell: Cell, latest: LatestValues, clock: Clock, record: WireRecorder) -> CellDevices:
    """Return every device of a cell, seen by latest and not connected.

    Args:
        cell: names drivers and endpoints.
        latest: takes what the devices report.
        clock: real time.
        record: takes what goes over the wires.

    Raises:
        ConfigError: a driver is not installed or a setting is wrong.
    """
    material = None if cell.material is None else cell.material.sensor
    devices = observed(device_builder(cell, clock)(record), latest, material)
    kept: dict[str, ObservedDevice] = {}
    for device in devices.named().values():
        if isinstance(device, ObservedDevice):
            kept[device.name] = device
    for further in cell.device:
        if further.name != material:
            kept[further.name] = _further(
                further.name,
                load_driver(further.driver).role,
                further_device(further, clock, record),
                latest,
            )
    return CellDevices(devices, kept)


def _further(name: str, role: Role, driver: Any, latest: LatestValues) -> ObservedDevice:
    """Return a device, seen, whose values are not those of the bench's own."""
    match role:
        case "environment":
            return ObservedSensor(name, driver, latest)
        case "robot":
            return ObservedController(name, driver, latest)
    return ObservedDevice(name, driver, latest)
