"""The instruments that a cell file names, made but not connected."""

import difflib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import partial
from typing import Any

from pydantic import ValidationError

from catseye.app.cell.axes import robot_driver
from catseye.app.cell.model import Cell, FurtherDevice, Robot
from catseye.app.engine.devices import DeviceBuilder, Devices, WireRecorder
from catseye.app.errors import ConfigError
from catseye.app.guard.client import ArmGuard
from catseye.drivers.roles.air import AirSensor
from catseye.drivers.roles.clock import Clock, SystemClock
from catseye.drivers.roles.device import Entry, Role
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.registry import load_driver


def device_builder(cell: Cell, clock: Clock) -> DeviceBuilder:
    """Return what makes the instruments of a cell.

    Args:
        cell: names drivers and endpoints.

    Raises:
        ConfigError: a driver is not installed or a setting is wrong.
    """
    build = partial(_build, cell, clock)
    # A wrong setting shows before a run is opened.
    build(unrecorded)
    return build


def require_drivers(cell: Cell) -> None:
    """Check that every device of a cell has a driver that takes its settings.

    Raises:
        ConfigError: a driver is not installed or a setting is wrong.
    """
    clock = SystemClock()
    _build(cell, clock, unrecorded)
    for device in cell.device:
        further_device(device, clock, unrecorded)


def _build(cell: Cell, clock: Clock, record: WireRecorder) -> Devices:
    guard = ArmGuard(cell.robot.endpoint)
    settings = _settings(cell)
    settings["robot"] = robot_settings(cell.robot, record) | guard_setting(cell.robot.driver, guard)
    made = {
        role: _make(section.driver, role, section.endpoint, clock, record, settings[role], role)
        for role, section in cell.instruments.items()
    }
    return Devices(**made, material=_material(cell, clock, record), guard=guard)


def _settings(cell: Cell) -> dict[Role, dict[str, Any]]:
    """Return the settings of the drivers that take them as they stand in the file."""
    settings: dict[Role, dict[str, Any]] = {
        role: section.settings for role, section in cell.instruments.items()
    }
    if counter := cell.interferometer:
        settings["interferometer"] = _joined(
            "interferometer", _given(profile=counter.profile), counter.settings
        )
    if air := cell.environment:
        keys = _given(map=air.map, pressure_address=air.pressure_register)
        settings["environment"] = _joined("environment", keys, air.settings)
    return settings


def _material(cell: Cell, clock: Clock, record: WireRecorder) -> AirSensor | None:
    """Return the sensor of the links' temperature."""
    if cell.material is None:
        return None
    device = next(device for device in cell.device if device.name == cell.material.sensor)
    made: AirSensor = further_device(device, clock, record, "environment")
    return made


def further_device(
    device: FurtherDevice, clock: Clock, record: WireRecorder, role: Role | None = None
) -> Any:
    """Return the driver of a [[device]], not connected.

    Args:
        record: takes the bytes that pass.
        role: what it has to be a driver of; None for anything.

    Raises:
        ConfigError: the driver is not installed, has another role, or a setting is wrong.
    """
    return _make(device.driver, device.name, device.endpoint, clock, record, device.settings, role)


def robot_settings(robot: Robot, record: WireRecorder) -> dict[str, Any]:
    """Return the settings of the robot's driver.

    Drivers that follow by them are given the further endpoint of the controller and the speed of set points.

    Raises:
        ConfigError: no such driver is installed.
    """
    abilities = robot_driver(robot.driver).abilities
    settings: dict[str, Any] = {"expected_model": robot.expected_model}
    if key := abilities.further_endpoint:
        settings |= _given(**{key: robot.further_endpoints.get(key)})
    if abilities.following == "streamed":
        settings |= {
            "follow_speed_deg_s": robot.follow_speed_deg_s,
            "follow_acceleration_deg_s2": robot.follow_acceleration_deg_s2,
            # Datagrams of every cycle would drown what else goes to the robot.
            "stream_sink": partial(record, "robot-stream"),
        }
    return {**settings, **robot.settings}


def guard_setting(driver: str, guard: ArmGuard) -> dict[str, Any]:
    """Return the guard as a setting, for a robot's driver that hands its connections to one."""
    return {"guard": guard} if robot_driver(driver).abilities.takes_guard else {}


def stop_request(driver: str, device: str, settings: Mapping[str, Any]) -> bytes | None:
    """Return what stops an arm on a link on which anything may have been sent before; None: its driver knows nothing.

    Args:
        device: its name in the cell file, for texts.

    Raises:
        ConfigError: the driver is not installed or a setting is wrong.
    """
    with _configuration_errors(device, driver):
        if load_driver(driver).role != "robot":
            return None
        made = robot_driver(driver)
        # Settings of its connections are none of its own.
        own = {key: value for key, value in settings.items() if key in made.Settings.model_fields}
        return made.stop_request(made.Settings(**own))


def _given(**values: Any) -> dict[str, Any]:
    """Return the keys that the cell file sets; the driver has a default for the others."""
    return {key: value for key, value in values.items() if value is not None}


def _joined(section: str, keys: dict[str, Any], settings: dict[str, Any]) -> dict[str, Any]:
    """Return the settings of a section with those that have keys of their own.

    Raises:
        ConfigError: one of them is given twice.
    """
    if twice := sorted(keys.keys() & settings.keys()):
        raise ConfigError(
            f"[{section}]: {twice[0]} is set in the section and in [{section}.settings]: leave one of them out"
        )
    return {**keys, **settings}


def _make(
    driver: str,
    device: str,
    endpoint: str,
    clock: Clock,
    record: WireRecorder,
    settings: dict[str, Any],
    role: Role | None,
) -> Any:
    def sink(entry: Entry, data: bytes) -> None:
        record(device, entry, data)

    if wrong := sorted(settings.keys() & {"endpoint", "clock", "sink"}):
        raise ConfigError(
            f"[{device}]: {wrong[0]} is not a setting of a driver: leave it out of the settings"
        )
    with _configuration_errors(device, driver):
        return load_driver(driver, role).at(endpoint, clock, sink, **settings)


def _unknown_setting(key: str, driver: str) -> str:
    known = sorted(load_driver(driver).Settings.model_fields)
    close = difflib.get_close_matches(key, known, n=1)
    meant = f"did you mean {close[0]!r}? " if close else ""
    return f"unknown setting; {meant}{driver} knows {', '.join(known)}"


@contextmanager
def _configuration_errors(device: str, driver: str) -> Iterator[None]:
    """Make an error of the configuration of what a driver raises.

    Raises:
        ConfigError: the driver is not installed or a setting is wrong.
    """
    try:
        yield
    except LookupError as error:
        raise ConfigError(f"[{device}] driver: {error.args[0]}") from error
    except ValidationError as error:
        first = error.errors()[0]
        key = ".".join(str(part) for part in first["loc"])
        text = _unknown_setting(key, driver) if first["type"] == "extra_forbidden" else first["msg"]
        raise ConfigError(f"[{device}] {key}: {text}") from error
    except DeviceError as error:
        raise ConfigError(f"[{device}]: {error}") from error


def unrecorded(_device: str, _entry: Entry, _data: bytes) -> None:
    """Record nothing of what passes on the wire."""
