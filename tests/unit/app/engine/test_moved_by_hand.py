"""An arm that somebody moves while a run is held in the middle of a way."""

import asyncio
from collections.abc import AsyncIterator, Callable
from dataclasses import dataclass
from pathlib import Path

import pytest

from catseye.app.engine.announcer import Announcer
from catseye.app.engine.context import RunContext
from catseye.app.engine.control import RunControl
from catseye.app.engine.devices import Devices
from catseye.app.engine.gate import MotionGate
from catseye.app.engine.operator import Operator
from catseye.app.protocol.state import ControlState
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.errors import ArmMovedError
from catseye.procedures.kit.live import Live
from tests.patience import until
from tests.unit.app.engine.fakes import ARM, FakeBench, free_way, straight

WAY: tuple[Pose, ...] = tuple((float(n), 2.0 * n, 0.0, 3.0 * n) for n in range(1, 9))


@pytest.fixture
async def store(tmp_path: Path) -> AsyncIterator[RunStore]:
    bench = FakeBench(tmp_path)
    opened = await RunStore.create(tmp_path, "script", {}, bench.clock, reserve_bytes=0)
    yield opened
    await opened.abandon()


@dataclass
class Door:
    """A condition of the surroundings.

    Attributes:
        open: it forbids motion.
        looks: how often it was looked at while open.
        meanwhile: called at the first look that finds it open.
    """

    open: bool = False
    looks: int = 0
    meanwhile: Callable[[], None] = lambda: None

    async def trouble(self) -> str | None:
        if not self.open:
            return None
        self.looks += 1
        self.meanwhile()
        # Closed again before the next look.
        self.open = self.looks < 2
        return "the door is open"


async def ready(store: RunStore, tmp_path: Path, *doors: Door) -> tuple[RunContext, RunControl, FakeBench]:
    """Return a context on a bench whose robot may move."""
    bench = FakeBench(tmp_path)
    control = RunControl(bench.clock, lambda _state, _reason: None)
    control.attach(bench.robot)
    control.starting()
    control.started()
    await bench.robot.servo(on=True)
    await bench.robot.set_override(20.0)
    announcer = Announcer(store.path.name, bench.clock, bench.publish, lambda _error: None)
    devices = Devices(bench.robot, bench.counter, bench.air)
    operator = Operator(bench.clock, {}, None, simulated=True)
    gate = MotionGate(bench.robot, ARM.axes, free_way, 20.0, doors)
    ctx = RunContext(devices, store, control, bench.clock, ARM.axes, gate, operator, announcer, straight)
    return ctx, control, bench


def jog(bench: FakeBench, by_deg: float) -> None:
    """Move J1 by hand."""
    one, two, three, four = bench.robot.pose
    bench.robot.pose = (one + by_deg, two, three, four)


async def until_held(control: RunControl) -> None:
    control.hold("a person")
    await until(lambda: control.state == ControlState.HELD)


async def held_on_the_way(store: RunStore, tmp_path: Path, jogged_deg: float) -> FakeBench:
    """Hold a way after its first targets, move J1 meanwhile, and go on."""
    ctx, control, bench = await ready(store, tmp_path)
    driving = asyncio.create_task(ctx.follow(WAY))
    await bench.robot.moving.wait()
    await until_held(control)
    jog(bench, jogged_deg)
    control.unhold("a person")
    await driving
    return bench


async def test_a_path_does_not_continue_from_an_unplanned_pose(store: RunStore, tmp_path: Path) -> None:
    with pytest.raises(ArmMovedError, match="was moved while the run was held or suspended") as caught:
        await held_on_the_way(store, tmp_path, 5.0)
    assert "leave the arm alone" in str(caught.value)


@pytest.mark.parametrize("jogged_deg", [0.0, 0.02])
async def test_a_way_goes_on_where_it_was_left(store: RunStore, tmp_path: Path, jogged_deg: float) -> None:
    bench = await held_on_the_way(store, tmp_path, jogged_deg)
    assert bench.robot.pose == WAY[-1]
    assert bench.robot.calls.count("move") == len(WAY)


async def test_an_arm_moved_behind_an_open_door_stays_put(store: RunStore, tmp_path: Path) -> None:
    door = Door()
    ctx, _, bench = await ready(store, tmp_path, door)
    await ctx.move(WAY[0])
    door.open, door.meanwhile = True, lambda: jog(bench, 5.0)
    with pytest.raises(ArmMovedError, match="held or suspended"):
        await ctx.move(WAY[1])
    assert door.looks == 2
    assert bench.robot.calls.count("move") == 1


async def test_a_move_does_not_begin_from_an_unplanned_pose(store: RunStore, tmp_path: Path) -> None:
    ctx, control, bench = await ready(store, tmp_path)
    await ctx.move(WAY[0])
    control.hold("a person")
    moving = asyncio.create_task(ctx.move(WAY[1]))
    await until_held(control)
    jog(bench, 5.0)
    control.unhold("a person")
    with pytest.raises(ArmMovedError, match="held or suspended"):
        await moving
    assert bench.robot.calls.count("move") == 1


async def test_an_arm_moved_during_a_question_does_not_drive_on(store: RunStore, tmp_path: Path) -> None:
    """Also one that was held meanwhile, which takes effect at no checkpoint then."""
    ctx, control, bench = await ready(store, tmp_path)
    await ctx.move(WAY[0])

    async def moved_by_hand() -> Live:
        control.hold("a person")
        jog(bench, 5.0)
        control.unhold("a person")
        return Live("level", 0.0, "mm")

    await ctx.ask(Prompt(id="level", kind="confirm", text="Is it level?", safe_answer="yes"), moved_by_hand)
    with pytest.raises(ArmMovedError, match="a question was open"):
        await ctx.move(WAY[1])
    assert bench.robot.calls.count("move") == 1


async def test_reading_the_pose_permits_moving_on_from_there(store: RunStore, tmp_path: Path) -> None:
    ctx, control, bench = await ready(store, tmp_path)
    await ctx.move(WAY[0])
    control.hold("a person")
    looking = asyncio.create_task(ctx.joints())
    await until_held(control)
    jog(bench, 5.0)
    control.unhold("a person")
    assert (await looking)[0] == WAY[0][0] + 5.0
    await ctx.move(WAY[1])
    assert bench.robot.pose == WAY[1]


@pytest.mark.parametrize(("jogged_deg", "goes_on"), [(0.0, True), (0.02, True), (0.1, False)])
async def test_a_read_back_beside_the_command_is_no_hand(
    store: RunStore, tmp_path: Path, jogged_deg: float, goes_on: bool
) -> None:
    ctx, _, bench = await ready(store, tmp_path)
    # As far beside as the driver itself lets a motion end.
    bench.robot.off = bench.robot.read_back_limit = 0.08
    await ctx.move(WAY[0])
    await ctx.ask(Prompt(id="level", kind="confirm", text="Is it level?", safe_answer="yes"))
    jog(bench, jogged_deg)
    if goes_on:
        await ctx.move(WAY[1])
        assert bench.robot.pose == WAY[1]
        return
    with pytest.raises(ArmMovedError, match="a question was open"):
        await ctx.move(WAY[1])


async def test_joints_that_were_read_are_compared_with_joints_read(store: RunStore, tmp_path: Path) -> None:
    ctx, _, bench = await ready(store, tmp_path)
    bench.robot.off = bench.robot.read_back_limit = 0.08
    await ctx.move(WAY[0])
    await ctx.joints()
    await ctx.ask(Prompt(id="level", kind="confirm", text="Is it level?", safe_answer="yes"))
    jog(bench, -0.08)
    with pytest.raises(ArmMovedError, match="a question was open"):
        await ctx.move(WAY[1])
