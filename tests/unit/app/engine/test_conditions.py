"""The air before a motion; controller and air under the eyes of the watchman."""

import asyncio
import logging
from collections.abc import AsyncIterator
from dataclasses import replace
from typing import Any

import pytest

from catseye.app.cell.model import Conditions
from catseye.app.engine.conditions import AirInRange, Condition, Watchman
from catseye.app.engine.control import RunControl
from catseye.app.engine.gate import require_ready
from catseye.app.engine.halt import HaltLimits
from catseye.app.engine.measuring import AirCache
from catseye.app.engine.waiting import cancel
from catseye.app.errors import InterruptionError, SafetyError
from catseye.app.protocol.state import ControlState
from catseye.drivers.roles.air import AirSample
from catseye.drivers.roles.errors import LinkError
from catseye.drivers.roles.robot import RobotStatus
from tests.unit.app.engine.fakes import FakeAir, FakeRobot, ManualClock

LIMITS = Conditions(temperature_c=[15.0, 25.0], pressure_hpa=[800.0, 1100.0])


class Sensor(FakeAir):
    """Returns what a test has set."""

    temperature_c: float = 20.0

    async def sample(self) -> AirSample:
        self.samples += 1
        return AirSample(self.temperature_c, self.pressure_hpa, 50.0, self.clock.monotonic_s())


class Surroundings:
    """A run with air in two places, and the watchman over it."""

    def __init__(self) -> None:
        self.clock = ManualClock()
        self.robot = FakeRobot(self.clock)
        self.robot.state = replace(self.robot.state, servo_on=True, override_percent=20.0)
        self.air, self.elsewhere = Sensor(self.clock), Sensor(self.clock)
        self.entered: list[str] = []
        self.control = RunControl(
            self.clock, lambda state, _reason: self.entered.append(state), HaltLimits(standstill_s=0.5)
        )
        self.control.attach(self.robot)
        self.control.starting()
        self.control.started()
        conditions: list[Condition] = [
            AirInRange(AirCache(air, self.clock, 2.0), LIMITS) for air in (self.air, self.elsewhere)
        ]
        # Longer than what the clock lets pass at once: the test decides when the watchman looks.
        self.watchman = Watchman(self.control, self.robot, conditions, self.ready, self.clock, 5.0)

    def ready(self, status: RobotStatus) -> None:
        require_ready(status)
        if status.override_percent > 20.0:
            raise InterruptionError("the override was raised")

    async def look(self) -> ControlState:
        """Let the watchman look once."""
        await turns()
        self.clock.advance(5.0)
        await turns()
        return self.control.state


@pytest.fixture
async def around() -> AsyncIterator[Surroundings]:
    made = Surroundings()
    task = asyncio.create_task(made.watchman.watch())
    yield made
    await cancel(task)
    await made.control.halted()


async def turns() -> None:
    for _ in range(20):
        await asyncio.sleep(0)


@pytest.mark.parametrize(
    ("temperature_c", "pressure_hpa", "words"),
    [
        (15.0, 1100.0, None),
        (25.01, 1000.0, "temperature is 25.01 °C, outside 15 … 25 °C"),
        (20.0, 799.9, "pressure is 799.90 hPa, outside 800 … 1100 hPa"),
        (20.0, None, None),
    ],
)
async def test_air_outside_its_range_is_named_with_value_and_unit(
    temperature_c: float, pressure_hpa: float | None, words: str | None
) -> None:
    sensor = Sensor(ManualClock())
    sensor.temperature_c, sensor.pressure_hpa = temperature_c, pressure_hpa
    trouble = await AirInRange(AirCache(sensor, sensor.clock, 2.0), LIMITS).trouble()
    assert (trouble is None) == (words is None)
    assert (words or "") in (trouble or "")


async def test_air_out_of_range_suspends_a_standing_run_until_back(around: Surroundings) -> None:
    assert await around.look() == ControlState.EXECUTE
    around.air.temperature_c = 30.0
    assert await around.look() == ControlState.SUSPENDED
    assert await around.look() == ControlState.SUSPENDED
    around.air.temperature_c = 20.0
    assert await around.look() == ControlState.EXECUTE
    assert around.entered[2:] == ["SUSPENDED", "EXECUTE"]


async def test_air_that_comes_back_does_not_end_the_operators_hold(around: Surroundings) -> None:
    around.air.temperature_c = 30.0
    assert await around.look() == ControlState.SUSPENDED
    around.control.hold("operator")
    around.air.temperature_c = 20.0
    assert await around.look() == ControlState.HOLDING
    with pytest.raises(TimeoutError):
        async with asyncio.timeout(0.01):
            await around.control.checkpoint()
    assert around.control.state == ControlState.HELD


async def test_the_watchman_ends_only_what_he_began(around: Surroundings) -> None:
    around.control.suspend("the laser is not ready")
    assert await around.look() == ControlState.SUSPENDED
    around.control.condition_back("the laser is ready")
    assert await around.look() == ControlState.EXECUTE


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"emergency_stop": True}, "emergency stop is open"),
        ({"alarm_number": 1020, "alarm_text": "servo error"}, "alarm 1020: servo error"),
        ({"servo_on": False}, "drives are off"),
        ({"teach_mode": True}, "TEACH"),
        ({"machine_locked": True}, "machine lock is on"),
    ],
)
async def test_a_controller_not_ready_to_move_aborts_at_rest(
    around: Surroundings, change: dict[str, Any], words: str
) -> None:
    around.robot.state = replace(around.robot.state, **change)
    await around.look()
    assert isinstance(around.control.ending, SafetyError)
    assert words in str(around.control.ending)
    await around.control.halted()
    assert around.control.state == ControlState.ABORTED


async def test_a_silent_link_is_logged_once_and_does_not_interrupt(
    around: Surroundings, caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def silent() -> RobotStatus:
        raise LinkError("robot at tcp://x: no answer")

    caplog.set_level(logging.WARNING)
    monkeypatch.setattr(around.robot, "status", silent)
    assert await around.look() == ControlState.EXECUTE
    assert await around.look() == ControlState.EXECUTE
    assert [record.message for record in caplog.records] == [
        "the surroundings cannot be watched: robot at tcp://x: no answer"
    ]


async def test_a_silent_sensor_hides_no_other_and_proves_nothing_back(
    around: Surroundings, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def silent() -> AirSample:
        raise LinkError("environment at tcp://x: no answer")

    answering = around.air.sample
    monkeypatch.setattr(around.air, "sample", silent)
    around.elsewhere.temperature_c = 30.0
    assert await around.look() == ControlState.SUSPENDED
    around.elsewhere.temperature_c = 20.0
    assert await around.look() == ControlState.SUSPENDED
    monkeypatch.setattr(around.air, "sample", answering)
    assert await around.look() == ControlState.EXECUTE


async def test_the_air_is_not_looked_at_during_a_motion(around: Surroundings) -> None:
    around.control.moving = True
    around.air.temperature_c = 30.0
    assert await around.look() == ControlState.EXECUTE


async def test_an_override_raised_during_a_motion_stops_it(around: Surroundings) -> None:
    around.control.moving = True
    around.robot.state = replace(around.robot.state, override_percent=50.0)
    await around.look()
    await around.control.halted()
    assert around.robot.calls == ["stop"]
    assert around.control.state == ControlState.UNSUSPENDING


@pytest.mark.parametrize(
    "change", [{"emergency_stop": True}, {"servo_on": False}, {"teach_mode": True}, {"machine_locked": True}]
)
async def test_a_controller_that_may_not_move_aborts_during_a_motion(
    around: Surroundings, change: dict[str, Any]
) -> None:
    around.control.moving = True
    around.robot.state = replace(around.robot.state, **change)
    await around.look()
    await around.control.halted()
    assert around.robot.calls[0] == "stop"
    assert around.control.state == ControlState.ABORTED
