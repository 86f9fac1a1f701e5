"""Emulated hardware for a cell file: its configuration, and a process of its own that serves it."""

import asyncio
import json
import sys
import tempfile
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from catseye.app.cell.axes import robot_driver
from catseye.app.cell.hands import hands_endpoint, tracker_driver
from catseye.app.cell.model import Cell, Interferometer
from catseye.app.cell.tracker import Tracker
from catseye.app.errors import ConfigError, LinkFailedError
from catseye.drivers.counter.profile import load_profile
from catseye.drivers.roles.errors import ProfileError
from catseye.drivers.roles.registry import driver_names, load_driver
from catseye.simulators.config import (
    EmulatedDevice,
    Option,
)
from catseye.simulators.control_port.client import ask
from catseye.simulators.control_port.messages import ReadTruth
from catseye.simulators.emulator import emulator_names

_READY_TIMEOUT_S = 20.0
_LAST = "control"
"""Every emulated bench has it; its endpoint is printed after those of the devices."""


def emulated_devices(cell: Cell) -> tuple[EmulatedDevice, ...]:
    """Return every endpoint of a cell's devices with the protocol that its driver speaks.

    Raises:
        ConfigError: there is no emulator of what a driver speaks.
    """
    robot = cell.robot
    spoken = robot_driver(robot.driver).protocols or {"endpoint": robot.driver}
    devices = [EmulatedDevice("robot", spoken["endpoint"], robot.endpoint)]
    for key, endpoint in robot.further_endpoints.items():
        driver, protocol = _speaker(key)
        # The settings are those of the driver in use.
        used = _plain(robot.settings) if robot.driver == driver else {}
        devices.append(EmulatedDevice("robot", protocol, endpoint, used))
    if counter := cell.interferometer:
        settings = {**_lengths_of(counter), **counter.settings}
        devices.append(_device("interferometer", counter.driver, counter.endpoint, settings))
    if air := cell.environment:
        options = {**air.settings, "map": air.map, "pressure_address": air.pressure_register}
        devices.append(_device("environment", air.driver, air.endpoint, options))
    if cell.io is not None:
        devices.append(_device("io", cell.io.driver, cell.io.endpoint, cell.io.settings))
    if cell.tracker is not None:
        devices += _tracker(cell.tracker)
    devices += [_device(d.name, d.driver, d.endpoint, d.settings) for d in cell.device]
    return tuple(devices)


def control_endpoint(cell: Cell) -> str:
    """Return where the control port of a cell's emulated bench listens: where the cell says, or anywhere.

    Raises:
        ConfigError: the tracker's driver is not installed.
    """
    return hands_endpoint(cell) or "tcp://127.0.0.1:0"


def _tracker(tracker: Tracker) -> list[EmulatedDevice]:
    """Return the emulated tracker; none where the control port is one, or a file that somebody else writes."""
    if tracker_driver(tracker.driver).protocols is not None:
        return []
    return [_device("tracker", tracker.driver, tracker.endpoint, tracker.settings)]


def _speaker(key: str) -> tuple[str, str]:
    """Return the driver of a robot that takes a further endpoint, and what it speaks there."""
    drivers = {name: load_driver(name) for name in driver_names()}
    return next(
        (name, driver.protocols[key])
        for name, driver in drivers.items()
        if driver.role == "robot" and driver.protocols is not None and key in driver.protocols
    )


def _lengths_of(counter: Interferometer) -> dict[str, str]:
    """Return whether an emulated line counter corrects for the air: as its profile says."""
    if counter.driver != "line-counter":
        return {}
    try:
        return {"compensated": load_profile(counter.profile or "default").compensated}
    except ProfileError as error:
        raise ConfigError(f"[interferometer]: {error}") from error


def _device(name: str, driver: str, endpoint: str, settings: Mapping[str, Any]) -> EmulatedDevice:
    """Return an emulated device; drivers and emulators call what they have in common by the same name."""
    known = emulator_names()
    if driver not in known:
        raise ConfigError(
            f"[{name}] driver {driver}: there is no emulator for it; there are {', '.join(known)}"
        )
    return EmulatedDevice(name, driver, endpoint, _plain(settings))


def _plain(settings: Mapping[str, Any]) -> dict[str, Option]:
    return {
        key: value for key, value in settings.items() if isinstance(value, str | int | float | bool | list)
    }


@dataclass(frozen=True)
class EmulatorProcess:
    """A running emulator.

    Attributes:
        endpoints: endpoint of each device: robot, interferometer, environment, control.
        process: the operating system's process.
    """

    endpoints: dict[str, str]
    process: asyncio.subprocess.Process


@asynccontextmanager
async def emulator_process(
    cell_path: Path, speed: float, seed: int, truth: Path | None
) -> AsyncIterator[EmulatorProcess]:
    """Run `catseye emulate` in a process of its own and yield it when all devices answer.

    Raises:
        LinkFailedError: it did not come up; the text is what it said.
    """
    arguments = ["emulate", str(cell_path), "--speed", f"{speed:g}", "--seed", str(seed)]
    if truth is not None:
        arguments += ["--truth", str(truth)]
    with tempfile.TemporaryFile() as said:
        process = await asyncio.create_subprocess_exec(
            sys.executable,
            "-P",
            "-m",
            "catseye",
            *arguments,
            "--end-with-stdin",
            # The pipe closes with this process, however it ends, and the emulator with the pipe.
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE,
            stderr=said,
            # A Ctrl-C in the terminal goes to the program, which stops the robot before the emulator ends.
            start_new_session=True,
        )
        try:
            yield EmulatorProcess(await _endpoints(process, said), process)
        finally:
            await _end(process)


async def fetch_truth(control: str) -> dict[str, Any]:
    """Return the true arm of an emulated bench, as a result document.

    Args:
        control: endpoint of its control port.

    Raises:
        LinkFailedError: the control port does not answer.
    """
    try:
        return (await ask(control, ReadTruth(), _READY_TIMEOUT_S)).truth
    except (OSError, ValueError) as error:
        raise LinkFailedError(
            f"the emulated bench at {control} does not reveal its truth: {error}"
        ) from error


async def _endpoints(process: asyncio.subprocess.Process, stderr: BinaryIO) -> dict[str, str]:
    found: dict[str, str] = {}
    stdout = process.stdout
    if stdout is None:
        raise LinkFailedError("the emulator was started without a pipe")
    try:
        async with asyncio.timeout(_READY_TIMEOUT_S):
            while _LAST not in found:
                line = await stdout.readline()
                if not line:
                    stderr.seek(0)
                    said = stderr.read().decode(errors="replace").strip()
                    raise LinkFailedError(f"the emulator did not start: {said or 'it said nothing'}")
                served = json.loads(line)
                found[served["device"]] = served["endpoint"]
    except TimeoutError as error:
        raise LinkFailedError(
            f"the emulator did not start within {_READY_TIMEOUT_S:g} s; try: catseye emulate CELL"
        ) from error
    return found


async def _end(process: asyncio.subprocess.Process) -> None:
    if process.returncode is None:
        process.terminate()
    try:
        async with asyncio.timeout(5.0):
            await process.communicate()
    except TimeoutError:
        process.kill()
        await process.communicate()
