"""Observed devices do what their drivers do, and what they say is seen."""

import asyncio
from collections.abc import Sequence
from typing import ClassVar

import pytest

from catseye.app.engine.devices import Devices
from catseye.app.service.watching.device_supervisor import round_for
from catseye.app.service.watching.latest_values import LatestValues
from catseye.app.service.watching.observed_devices import (
    ObservedAir,
    ObservedDevice,
    ObservedInterferometer,
    ObservedIo,
    observed,
)
from catseye.drivers.roles.errors import (
    AlarmError,
    DeviceError,
    LinkTimeoutError,
    ProtocolError,
    RefusedError,
)
from catseye.drivers.roles.io import Io, Light
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotAbilities
from tests.unit.app.service.watching.pulled_devices import (
    Pulled,
    PulledAir,
    PulledCell,
    PulledRobot,
    StreamingCounter,
)
from tests.unit.drivers.virtual_time import VirtualClock, run


def test_answers_pass_and_are_seen_with_their_time() -> None:
    async def ask() -> None:
        latest, cell = LatestValues(VirtualClock()), PulledCell()
        devices = cell.observed(latest)
        identity = await devices.robot.connect()
        assert (identity.model, latest.links["robot"].state) == ("model", "ok")
        await devices.robot.servo(on=True)
        assert await devices.robot.set_override(7.0) == 7.0
        await devices.robot.move_joints((1.0, 0.0, 0.0, 0.0))
        await devices.robot.stop()
        assert cell.robot.log == ["connect", "servo True", "override", "move (1.0, 0.0, 0.0, 0.0)", "stop"]
        joints = await devices.robot.joints()
        status = await devices.robot.status()
        assert latest.joints is not None
        assert latest.status is not None
        assert (latest.joints.value, latest.status.value) == (joints, status)
        assert latest.status.time_s == VirtualClock().monotonic_s() == latest.joints.time_s + 0.005
        assert devices.interferometer is not None
        assert devices.environment is not None
        reading, beam = await devices.interferometer.read(), await devices.interferometer.status()
        air = await devices.environment.sample()
        assert latest.displacement_mm is not None
        assert latest.beam is not None
        assert latest.air is not None
        assert latest.displacement_mm.value == reading.displacement_mm
        assert (latest.beam.value, latest.air.value) == (beam, air)
        assert await devices.interferometer.zero() == 1
        await devices.robot.close()
        assert latest.links["robot"].state == "closed"

    run(ask())


def test_an_observed_robot_can_do_what_its_driver_can() -> None:
    class Way(PulledRobot):
        abilities: ClassVar[RobotAbilities] = RobotAbilities(following="blended")

        async def follow(self, way: Sequence[Pose]) -> None:
            await self._asked(f"follow {len(way)}")

    async def follow() -> None:
        latest, cell = LatestValues(VirtualClock()), PulledCell()
        plain = cell.observed(latest)
        assert plain.robot.abilities.following == "stops"
        assert plain.interferometer is not None
        assert plain.interferometer.compensated == "none"
        cell.robot = Way()
        way = cell.observed(latest).robot
        assert way.abilities.following == "blended"
        await way.follow([(0.0, 0.0, 0.0, 0.0)] * 3)
        assert cell.robot.log == ["follow 3"]

    run(follow())


def test_an_observed_robot_steps_as_its_driver_does() -> None:
    class Stepping(PulledRobot):
        abilities: ClassVar[RobotAbilities] = RobotAbilities(
            steps=True, torques=True, command_resolution={"deg": 0.001}
        )

        async def step_to(self, target: Pose) -> None:
            await self._asked(f"step to {target}")

        async def step_axis(self, axis: str, increment: float) -> None:
            await self._asked(f"step {axis} by {increment:g}")

        async def step_line(self, increment_mm: tuple[float, float, float]) -> None:
            await self._asked(f"line {increment_mm}")

        async def torques(self) -> tuple[float, ...]:
            await self._asked("torques")
            return (1.5, -2.0)

    async def step() -> None:
        cell = PulledCell()
        cell.robot = Stepping()
        latest = LatestValues(VirtualClock())
        robot = cell.observed(latest).robot
        assert robot.abilities.steps
        await robot.step_to((1.0, 2.0))
        await robot.step_axis("A1", 0.01)
        await robot.step_line((1.0, 0.0, 0.0))
        assert await robot.torques() == (1.5, -2.0)
        assert latest.torques_nm is not None
        assert latest.torques_nm.value == (1.5, -2.0)
        assert isinstance(robot, ObservedDevice)
        assert [question.__name__ for question in round_for(robot).questions] == [
            "status",
            "joints",
            "torques",
        ]
        assert cell.robot.log == ["step to (1.0, 2.0)", "step A1 by 0.01", "line (1.0, 0.0, 0.0)", "torques"]

    run(step())


async def test_a_robot_without_steps_refuses_them_and_says_so() -> None:
    robot = PulledCell().robot
    with pytest.raises(RefusedError, match="steps no axis"):
        await robot.step_axis("A1", 0.01)
    with pytest.raises(RefusedError, match="along no line"):
        await robot.step_line((1.0, 0.0, 0.0))
    with pytest.raises(RefusedError, match="no motor torques"):
        await robot.torques()


def test_notes_of_a_driver_are_passed_on() -> None:
    class Noting(PulledAir):
        notes = ("old firmware",)

    latest = LatestValues(VirtualClock())
    assert ObservedAir("environment", Noting(), latest).notes == ("old firmware",)
    assert ObservedAir("environment", PulledAir(), latest).notes == ()


def test_doors_and_links_temperatures_are_seen() -> None:
    class Door(Pulled, Io):
        async def door_closed(self) -> bool:
            await self._asked("door")
            return False

        async def show(self, light: Light) -> None:
            await self._asked(light)

    async def look() -> None:
        latest, io, steel = LatestValues(VirtualClock()), Door(), PulledAir()
        door = ObservedIo("io", io, latest)
        assert await door.door_closed() is False
        await door.show("green")
        assert latest.door_closed is not None
        assert (latest.door_closed.value, io.log) == (False, ["door", "green"])
        cell = PulledCell()
        devices = observed(Devices(cell.robot, cell.counter, cell.air, material=steel), latest, "steel")
        assert devices.material is not None
        await devices.material.sample()
        assert latest.air is None
        assert latest.links["steel"].state == "ok"

    run(look())


@pytest.mark.parametrize("error", [LinkTimeoutError("silent"), ProtocolError("garbage")])
def test_a_link_that_fails_is_lost_until_it_answers(error: DeviceError) -> None:
    async def fail() -> None:
        latest, cell = LatestValues(VirtualClock()), PulledCell()
        devices = cell.observed(latest)
        cell.robot.error = error
        with pytest.raises(type(error)):
            await devices.robot.status()
        assert (latest.links["robot"].state, latest.links["robot"].error) == ("lost", str(error))
        cell.robot.error = None
        await devices.robot.status()
        assert (latest.links["robot"].state, latest.links["robot"].error) == ("ok", None)

    run(fail())


@pytest.mark.parametrize("refusal", [RefusedError("no beam", 3), AlarmError("hot", 4)])
def test_a_refusal_is_an_answer(refusal: DeviceError) -> None:
    async def refuse() -> None:
        latest, cell = LatestValues(VirtualClock()), PulledCell()
        devices = cell.observed(latest)
        cell.counter.refusal = refusal
        assert devices.interferometer is not None
        with pytest.raises(type(refusal)):
            await devices.interferometer.read()
        assert latest.links["interferometer"].state == "ok"
        assert latest.displacement_mm is None

    run(refuse())


def test_every_value_of_a_stream_is_seen_once() -> None:
    async def stream() -> None:
        latest, driver = LatestValues(VirtualClock()), StreamingCounter()
        counter = ObservedInterferometer("interferometer", driver, latest)
        assert driver.on_value is not None
        for number in range(5):
            driver.on_value(0.0, float(number))
        # What is read has come by the stream already.
        await counter.read()
        await asyncio.sleep(0.02)
        taken = latest.columns.take(VirtualClock().monotonic_s())
        assert (taken.count, taken.low, taken.high) == ([5], [0.0], [4.0])

    run(stream())


def test_somebody_who_waits_for_an_answer_is_seen() -> None:
    async def wait() -> None:
        robot = PulledCell().observed(LatestValues(VirtualClock())).robot
        assert not robot.busy  # type: ignore[attr-defined]  # it is an observed one
        asking = asyncio.create_task(robot.status())
        await asyncio.sleep(0)
        assert robot.busy  # type: ignore[attr-defined]  # it is an observed one
        await asking
        assert not robot.busy  # type: ignore[attr-defined]  # it is an observed one

    run(wait())
