"""Drivers in front of emulated devices that lose their power: healed, or stopped with what is to be done."""

import asyncio
from typing import Any

import pytest

from catseye.drivers.roles.errors import DeviceError, LinkError, NotReadyError, RefusedError
from catseye.simulators.control_port import faults
from catseye.simulators.control_port.messages import PressKey
from catseye.simulators.control_port.operations import carry_out
from catseye.simulators.emulated_bench import ServedBench
from tests.patience import until
from tests.unit.drivers import abb_rig, test_kuka_robot, test_leica_tracker, test_t2sa_tracker
from tests.unit.simulators.trackers import near


def cut(bench: ServedBench, device: str) -> None:
    """Take the power of a device until it is given back."""
    carry_out(faults.CutPower(device=device, duration_s=1e9), bench.reach)


def give_back(bench: ServedBench, device: str) -> None:
    """Let the power of a device come back now."""
    bench.context.power_back_s[device] = bench.context.bench.time_s
    for port in bench.reach.ports_of(device):
        port.off_until_s = 0.0


async def lost_on_its_way(one: Any) -> BaseException:
    """Cut a robot's power while its arm moves, and give it back; return how the motion ended."""
    motion = await one.away()
    cut(one.bench, "robot")
    error = await abb_rig.failed(motion)
    give_back(one.bench, "robot")
    return error


async def stands(one: Any) -> tuple[float, ...]:
    """Wait until the arm stands; return where."""
    bench = one.bench.bench
    await until(lambda: one.bench.keeper.sync() >= bench.standstill_s)
    return tuple(bench.joints)


async def test_a_kuka_without_power_waits_for_its_program() -> None:
    async with test_kuka_robot.rig() as one:
        error = await lost_on_its_way(one)
        assert isinstance(error, LinkError)
        assert "power" in str(error)
        place = await stands(one)
        status = await one.robot.status()
        assert (status.servo_on, status.operation_enabled) == (False, False)
        carry_out(PressKey(key="drives"), one.bench.reach)
        with pytest.raises(NotReadyError, match=r"P_FREE.*reset and start CATSKUKA"):
            await one.robot.move_joints(place)
        for key in ("reset", "start"):
            carry_out(PressKey(key=key), one.bench.reach)
        one.bench.keeper.sync()
        assert tuple(one.bench.bench.joints) == place
        await one.robot.set_override(10)
        goal = (place[0] + 0.5, *place[1:])
        await one.robot.move_joints(goal)
        assert one.a1_deg == pytest.approx(goal[0], abs=1e-4)


async def test_an_abb_without_power_moves_to_new_goals_only() -> None:
    async with abb_rig.rig() as one:
        error = await lost_on_its_way(one)
        assert isinstance(error, LinkError)
        assert "power" in str(error)
        place = await stands(one)
        with pytest.raises(NotReadyError, match=r"motoroff.*start CATSABB"):
            await one.robot.move_joints(place)
        await one.robot.servo(on=True)
        one.bench.keeper.sync()
        assert tuple(one.bench.bench.joints) == place
        await one.robot.set_override(5)
        goal = (place[0] - 0.5, *place[1:])
        await one.robot.move_joints(goal)
        journal = [e.text for e in one.bench.journal.entries("robot") if e.kind == "motion"]
        begun = [text for text in journal if text.startswith("motion")]
        assert len(begun) == 2, begun
        assert one.j1_deg == pytest.approx(goal[0], abs=1e-4)


async def test_a_leica_is_warmed_and_initialised_again() -> None:
    async with test_leica_tracker.rig({"warm_again_s": 86_400.0}) as one:
        await one.point("nest1")
        before = one.asked(7)
        measurement = asyncio.create_task(one.point("nest1", 60.0))
        await one.reaches(49)
        cut(one.bench, "tracker")
        with pytest.raises(DeviceError, match="power"):
            await measurement
        give_back(one.bench, "tracker")
        with pytest.raises(RefusedError, match="let it warm up"):
            await one.point("nest1")
        assert one.asked(7) == before
        one.bench.context.power_back_s["tracker"] -= 86_400.0
        await one.point("nest1")
        assert one.asked(7) == before + 1


async def test_a_t2sas_laser_is_to_be_switched_on() -> None:
    async with test_t2sa_tracker.rig(u_mm=0.02) as one:
        cut(one.bench, "tracker")
        with pytest.raises(LinkError, match="power"):
            await one.tracker.point("nest1", 0.0)
        give_back(one.bench, "tracker")
        with pytest.raises(RefusedError, match=r"LOFF.*switch it on"):
            await one.tracker.point("nest1", 0.0)


async def test_a_t2sas_laser_that_may_be_is_switched_on() -> None:
    async with test_t2sa_tracker.rig(u_mm=0.02, switches_laser_on=True) as one:
        cut(one.bench, "tracker")
        give_back(one.bench, "tracker")
        seen = await one.tracker.point("nest1", 0.0, near(one.bench, "nest1"))
        assert one.asked("!LST:1") == 1
        assert seen.place_mm == pytest.approx(near(one.bench, "nest1"), abs=0.1)
