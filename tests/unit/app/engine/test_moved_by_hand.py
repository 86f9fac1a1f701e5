"""An arm that somebody moves while a run is held in the middle of a way."""

import asyncio
from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from app.engine.announcer import Announcer
from app.engine.context import RunContext
from app.engine.control import RunControl
from app.engine.devices import Devices
from app.engine.gate import MotionGate
from app.engine.operator import Operator
from app.engine.states import State
from app.store.run_store import RunStore
from procedures.devices import Joints
from procedures.errors import ArmMovedError
from tests.unit.app.engine.fakes import LIMITS, FakeBench

WAY: tuple[Joints, ...] = tuple((float(n), 2.0 * n, 0.0, 3.0 * n) for n in range(1, 9))


@pytest.fixture
async def store(tmp_path: Path) -> AsyncIterator[RunStore]:
    bench = FakeBench(tmp_path)
    opened = await RunStore.create(tmp_path, "script", {}, bench.clock, reserve_bytes=0)
    yield opened
    await opened.abandon()


async def held_on_the_way(store: RunStore, tmp_path: Path, jogged_deg: float) -> FakeBench:
    """Hold a way after its first targets, move J1 meanwhile, and go on."""
    bench = FakeBench(tmp_path)
    control = RunControl(bench.clock, lambda _state, _reason: None)
    control.attach(bench.robot)
    control.starting()
    control.started()
    await bench.robot.servo(on=True)
    await bench.robot.set_override(20.0)
    announcer = Announcer(store.path.name, bench.clock, bench.publish, lambda: None)
    devices = Devices(bench.robot, bench.counter, bench.air)
    operator = Operator(bench.clock, {}, None, simulated=True)
    gate = MotionGate(bench.robot, LIMITS, 20.0)
    ctx = RunContext(devices, store, control, bench.clock, gate, operator, announcer)
    driving = asyncio.create_task(ctx.follow(WAY))
    await bench.robot.moving.wait()
    control.hold("a person")
    for _ in range(1000):
        if control.state == State.HELD:
            break
        await asyncio.sleep(0)
    assert control.state == State.HELD
    one, two, three, four = bench.robot.pose
    bench.robot.pose = (one + jogged_deg, two, three, four)
    control.unhold("a person")
    await driving
    return bench


async def test_a_way_does_not_go_on_from_where_nobody_planned_to_be(store: RunStore, tmp_path: Path) -> None:
    with pytest.raises(ArmMovedError, match="was moved while the run was held") as caught:
        await held_on_the_way(store, tmp_path, 5.0)
    assert "leave the arm alone" in str(caught.value)


@pytest.mark.parametrize("jogged_deg", [0.0, 0.05])
async def test_a_way_goes_on_where_it_was_left(store: RunStore, tmp_path: Path, jogged_deg: float) -> None:
    bench = await held_on_the_way(store, tmp_path, jogged_deg)
    assert bench.robot.pose == WAY[-1]
    assert bench.robot.calls.count("move") == len(WAY)
