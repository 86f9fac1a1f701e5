"""What stops the arm: on request, by the guard, for want of a sign of life, and when something fails."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from itertools import pairwise

import pytest

from catseye.app.testing.faulty import Fault, FaultyTransport
from catseye.drivers.abb.robot import USES, AbbRws
from catseye.drivers.abb.settings import AbbSettings
from catseye.drivers.links.endpoint import open_transport
from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.roles.errors import LinkError, NotReadyError, RefusedError
from catseye.simulators.abb.failing import Failing
from catseye.simulators.abb.program import Result
from catseye.simulators.config import Option
from catseye.simulators.emulated_bench import EmulatedAbbBench
from tests.patience import until
from tests.unit.drivers.abb_rig import AWAY, ORDER, STOP, STRICT, Rig, failed, rig
from tests.unit.drivers.guards import RecordingGuard
from tests.unit.simulators.abb.benches import BENT, abb_bench


@pytest.mark.parametrize("options", [{}, STRICT])
async def test_stop_overtakes_a_motion_and_the_next_starts(options: dict[str, Option]) -> None:
    async with rig(options) as one:
        motion = await one.away()
        await one.robot.stop()
        stood = one.j1_deg
        assert not one.bench.bench.moving
        assert 0.0 < stood < 60.0
        assert isinstance(await failed(motion), RefusedError)
        assert one.j1_deg == stood
        await one.robot.move_joints((stood + 0.5, *BENT[1:]))
        assert one.j1_deg == pytest.approx(stood + 0.5, abs=1e-4)


async def test_a_refused_stop_of_what_stands_is_confirmed() -> None:
    async with rig(stop_timeout_s=2.0) as one:
        motion = await one.away()
        one.bench.controller.failing = Failing("action=stop", carried_out=True, left=100_000)
        await one.robot.stop()
        assert not one.bench.bench.moving
        await failed(motion)


async def test_a_refused_stop_of_what_runs_is_reported() -> None:
    async with rig(stop_timeout_s=1.0) as one:
        motion = await one.away()
        one.bench.controller.failing = Failing("action=stop", carried_out=False, left=100_000)
        with pytest.raises(LinkError, match="PRESS THE EMERGENCY STOP"):
            await one.robot.stop()
        await failed(motion)


async def test_a_cancelled_motion_is_stopped() -> None:
    async with rig() as one:
        motion = await one.away()
        motion.cancel()
        assert isinstance(await failed(motion), asyncio.CancelledError)
        assert not one.bench.bench.moving
        assert one.asked("POST /rw/rapid/execution?action=stop")


async def test_a_cancellation_stops_before_connections_are_put_in_order() -> None:
    async with rig() as one:
        motion = await one.away()
        before = len(one.asked(""))
        motion.cancel()
        await failed(motion)
        later = one.asked("")[before:]
        stop = next(k for k, text in enumerate(later) if "action=stop" in text)
        assert stop < next(k for k, text in enumerate(later) if "action=release" in text)


@pytest.mark.parametrize("refused", ["^GET .*execution", "^GET .*cats_taken", "^GET .*cats_done"])
async def test_a_look_that_is_refused_stops_the_arm(refused: str) -> None:
    async with rig() as one:
        motion = await one.away()
        one.bench.controller.failing = Failing(refused, carried_out=False, left=1)
        assert isinstance(await failed(motion), RefusedError)
        assert one.asked(STOP)
        assert not one.bench.bench.moving
        assert one.bench.controller.program.data["cats_result"] == Result.UNDER_WAY


async def test_no_sign_of_life_is_given_once_a_stop_begins() -> None:
    async with rig(stop_timeout_s=1.5) as one:
        motion = await one.away()
        began_s = one.bench.bench.time_s
        one.bench.controller.failing = Failing(
            "action=stop|^GET .*execution", carried_out=False, left=100_000
        )
        assert isinstance(await failed(motion), RefusedError)
        assert one.bench.controller.program.data["cats_result"] == Result.NO_HEARTBEAT
        assert one.bench.bench.standstill_s - began_s < 1.0


async def test_an_order_of_which_nothing_is_known_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        await one.robot.set_override(5)
        controller, written = one.bench.controller, one.bench.controller.program.written

        def begin() -> None:
            if controller.program.data["cats_seq"] == 1.0:
                controller.failing = Failing("^GET .*cats_seq", carried_out=False, left=1)
            written()

        monkeypatch.setattr(controller.program, "written", begin)
        controller.failing = Failing("^POST .*cats_seq", carried_out=True, left=1)
        assert isinstance(await failed(one.robot.move_joints(AWAY)), RefusedError)
        assert one.asked(STOP)
        assert not one.bench.bench.moving


async def test_a_stop_during_the_start_is_called_so(monkeypatch: pytest.MonkeyPatch) -> None:
    async with rig() as one:
        one.bench.controller.press("stop")
        program, robot = one.bench.controller.program, one.robot
        stops: list[asyncio.Task[None]] = []

        def marked() -> None:
            # The number that marks the start is written: the next request is the reset.
            if not stops:
                stops.append(asyncio.create_task(robot.stop()))

        monkeypatch.setattr(program, "written", marked)
        with pytest.raises(RefusedError, match="a stop overtook") as caught:
            await robot.move_joints(AWAY)
        assert not isinstance(caught.value, NotReadyError)
        await stops[0]


async def test_an_operators_stop_ends_the_motion_with_advice() -> None:
    async with rig() as one:
        motion = await one.away()
        one.bench.controller.press("stop")
        error = await failed(motion)
        assert isinstance(error, NotReadyError)
        assert "stands" in str(error)


async def test_the_arm_stops_when_the_heartbeat_ends() -> None:
    async with rig() as one:
        motion = await one.away()
        # The process is gone: nothing closes anything, nothing says STOP.
        for port in one.bench.reach.ports_of("robot"):
            port.drop()
            port.stalled_until_s = 1e9
        began_s = one.bench.bench.time_s
        while one.bench.bench.moving:
            await asyncio.sleep(0)
            one.bench.keeper.sync()
        assert one.bench.bench.time_s - began_s < 0.7
        motion.cancel()
        for port in one.bench.reach.ports_of("robot"):
            port.stalled_until_s = 0.0
        await failed(motion)


@asynccontextmanager
async def behind(
    bench: EmulatedAbbBench, faults: dict[str, list[Fault]], settings: AbbSettings
) -> AsyncIterator[AbbRws]:
    """A driver of which some connections go wrong."""
    endpoint = bench.endpoints[0].endpoint
    first, second, third, fourth, fifth = (
        FaultyTransport(open_transport(endpoint), faults.get(use, [])) for use in USES
    )
    robot = AbbRws((first, second, third, fourth, fifth), SystemClock(), settings)
    try:
        await robot.connect()
        yield robot
    finally:
        await robot.close()


async def test_nothing_moves_without_a_connection_for_stop() -> None:
    # Its login needs two answers; then whatever it says is lost.
    silent = [Fault(at, "drop") for at in range(2, 1000)]
    async with (
        abb_bench() as bench,
        behind(bench, {"stop": silent}, AbbSettings(answer_timeout_s=0.1)) as robot,
    ):
        with pytest.raises(LinkError, match="stop connection"):
            await robot.move_joints(AWAY)
        assert not [e for e in bench.journal.entries("robot") if e.text.startswith(ORDER)]
        assert bench.bench.joints == BENT


SLOW_S = 0.4


async def test_slow_answers_to_signs_of_life_stop_nothing() -> None:
    slow = [Fault(at, "delay", amount_s=SLOW_S) for at in range(1000)]
    # At this period one connection would leave 0.4 s between two signs, of which CATSABB bears no more.
    settings = AbbSettings(heartbeat_s=0.2)
    async with abb_bench() as bench:
        async with behind(bench, {"heartbeat": slow, "second-heartbeat": slow}, settings) as robot:
            await robot.set_override(2)
            await robot.move_joints((8.0, *BENT[1:]))
        beats = [e.time_s for e in bench.journal.entries("robot") if "cats_beat" in e.text]
    assert len(beats) > 5
    assert max(late - early for early, late in pairwise(beats)) < SLOW_S


async def test_a_stop_that_nobody_hears_is_reported() -> None:
    async with rig(stop_timeout_s=0.3, answer_timeout_s=0.1) as one:
        for port in one.bench.reach.ports_of("robot"):
            port.muted = True
        with pytest.raises(LinkError, match="PRESS THE EMERGENCY STOP"):
            await one.robot.stop()


@pytest.mark.parametrize("options", [{}, STRICT])
async def test_the_guards_bytes_stop_the_arm_at_any_moment(options: dict[str, Option]) -> None:
    guard = RecordingGuard()
    async with abb_bench(options=options) as bench:
        endpoint = bench.endpoints[0].endpoint
        robot = AbbRws.at(endpoint, SystemClock(), guard=guard, renewal_s=0.05)
        await robot.connect()
        one = Rig(bench, robot)
        try:
            motion = await one.away()
            before = guard.taken
            # Renewed while the arm moves, and more than once.
            await until(lambda: guard.taken >= before + 2)
            assert guard.names == {"stop"}
            guard.write_stop("stop")
            while bench.bench.moving:
                await asyncio.sleep(0)
                bench.keeper.sync()
            assert 0.0 < one.j1_deg < 60.0
            assert isinstance(await failed(motion), NotReadyError)
        finally:
            await robot.close()
        assert not guard.names


async def test_the_guards_bytes_release_mastership_of_a_dead_program() -> None:
    guard = RecordingGuard()
    async with abb_bench(options=STRICT) as bench:
        endpoint = bench.endpoints[0].endpoint
        dead, other = (AbbRws.at(endpoint, SystemClock(), guard=one) for one in (guard, None))
        one = Rig(bench, dead)
        try:
            await dead.connect()
            await other.connect()
            motion = await one.away()
            guard.write_stop("stop")
            await failed(motion)
            # Signs of life come on a connection of their own, whenever they are due.
            asked = [text for text in one.asked("POST /rw/") if "cats_beat" not in text]
            stop = next(at for at, text in enumerate(asked) if "execution?action=stop" in text)
            assert "mastership/rapid?action=release" in asked[stop + 1]
            await other.set_override(50)
            await other.move_joints(BENT)
        finally:
            await dead.close()
            await other.close()
