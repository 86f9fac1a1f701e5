"""No instrument on the emulated bench knows better than a real one could: its answers are never the bench's truth."""

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any

import numpy as np
import pytest

from catseye.app.cell.load import load_cell
from catseye.app.engine.instruments import device_builder, further_device, unrecorded
from catseye.drivers.roles.air import AirSensor
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.interferometer import Interferometer
from catseye.drivers.roles.robot import Robot
from catseye.drivers.roles.tracker import Position, Tracker
from catseye.simulators.config import ErrorBudget
from tests.system.blocking import still_truth
from tests.system.command import Emulated, emulated
from tests.system.lossy import PLACES
from tests.system.test_every_protocol import every_protocol

BUDGET = ErrorBudget()
READINGS = 40


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("bench")
    # At the start the beam meets P2.
    options = ("--speed", "1", "--seed", "4", "--truth", str(still_truth(folder, PLACES)))
    with emulated(folder, *options, text=every_protocol(folder)) as running:
        yield running


def driver_of(bench: Emulated, name: str) -> Any:
    cell = load_cell(bench.cell).cell
    named = device_builder(cell, SystemClock())(unrecorded).named()
    further = {device.name: device for device in cell.device}
    return named.get(name) or further_device(further[name], SystemClock(), unrecorded)


def asked(device: Any, ask: Callable[[], Coroutine[Any, Any, Any]]) -> Any:
    async def work() -> Any:
        await device.connect()
        try:
            return await ask()
        finally:
            await device.close()

    return asyncio.run(work())


@pytest.mark.parametrize("name", ["interferometer", "nd287", "hpi", "ids", "umd"])
def test_lengths_scatter_as_the_counter_does(bench: Emulated, name: str) -> None:
    counter: Interferometer = driver_of(bench, name)

    async def read() -> list[float]:
        await counter.zero()
        return [(await counter.read()).displacement_mm for _ in range(READINGS)]

    spread_um = 1e3 * float(np.std(asked(counter, read)))
    # Of 40 normal readings the standard deviation lies within these with a probability of 0.999.
    assert 0.6 * BUDGET.counter_noise_um < spread_um < 1.5 * BUDGET.counter_noise_um + BUDGET.environment_um


@pytest.mark.parametrize("name", ["environment", "air-rtu", "ptu300"])
def test_the_air_is_known_as_well_as_its_sensors_are(bench: Emulated, name: str) -> None:
    sensor: AirSensor = driver_of(bench, name)
    sample = asked(sensor, sensor.sample)
    true = bench.ask(op="state")["air"]
    us = BUDGET.air_temperature_k, BUDGET.air_pressure_hpa, BUDGET.air_humidity_percent
    errors = [
        (measured - true[key]) / u
        for measured, key, u in zip(
            (sample.temperature_c, sample.pressure_hpa, sample.humidity_percent),
            ("temperature_c", "pressure_hpa", "humidity_percent"),
            us,
            strict=True,
        )
    ]
    assert all(0.02 < abs(error) < 4.0 for error in errors), errors


def test_places_scatter_as_the_tracker_says(bench: Emulated) -> None:
    tracker: Tracker = driver_of(bench, "tracker")

    async def locate() -> list[Position]:
        return [await tracker.locate() for _ in range(READINGS)]

    seen = asked(tracker, locate)
    for coordinate in ("x_mm", "y_mm"):
        spread = float(np.std([getattr(one, coordinate) / one.u_mm for one in seen]))
        assert 0.2 < spread < 1.5, coordinate


@pytest.mark.parametrize("name", ["robot", "robot-serial"])
def test_the_controller_reads_its_encoders_not_the_arm(bench: Emulated, name: str) -> None:
    robot: Robot = driver_of(bench, name)
    joints = np.array(asked(robot, robot.joints))
    true = np.array(bench.ask(op="state")["true_joints"])
    # The arm's error maps, and its play: a few mdeg.
    assert np.all(np.abs(joints - true)[[0, 1, 3]] > 1e-4)
    assert np.all(np.abs(joints - true)[[0, 1, 3]] < 0.5)
