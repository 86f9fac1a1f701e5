"""The real-time driver against a scripted controller and real-time port."""

import asyncio
import itertools
import math
import struct
from collections.abc import AsyncIterator, Callable, Iterable
from contextlib import asynccontextmanager
from dataclasses import dataclass, field

import pytest
from pydantic import ValidationError

from catseye.app.testing.memory import MemoryTransport
from catseye.drivers.melfa.mxt.robot import MelfaMxt
from catseye.drivers.melfa.mxt.settings import MxtSettings
from catseye.drivers.melfa.mxt.stream import SetPointStream
from catseye.drivers.melfa.robot import MelfaR3
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.errors import (
    AlarmError,
    LinkError,
    LinkTimeoutError,
    NotArrivedError,
    NotReadyError,
    RefusedError,
    WrongDeviceError,
)
from catseye.drivers.roles.pose import Pose
from tests.patience import until
from tests.unit.drivers.melfa_bench import Controller
from tests.unit.drivers.peers import Peer, StepClock

WAY: tuple[Pose, ...] = ((1.0, 2.0, 5.0, -3.0), (2.0, 4.0, 5.0, -6.5), (3.0, 6.0, 5.0, -10.0))
QUICK = {"quiet_s": 0.001, "answer_timeout_s": 0.2}


@dataclass
class RealTime:
    """The real-time port (sheet, section 2): answers each datagram with joints, one cycle behind the set point."""

    controller: Controller
    clock: StepClock
    cycle_s: float = 0.0071
    set_points: list[tuple[float, ...]] = field(default_factory=list)
    ends: int = 0
    at: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    last: tuple[float, ...] | None = None
    lose: Callable[[int], bool] = lambda _number: False
    deaf: bool = False
    garbage: int = 0
    frozen: bool = False
    later: float = 0.0
    before: tuple[float, ...] | None = None

    def answer(self, data: bytes) -> Iterable[bytes]:
        """Answer a datagram."""
        assert len(data) == 196
        command, kind = struct.unpack_from("<2H", data, 0)
        if self.deaf:
            return []
        if self.garbage:
            self.garbage -= 1
            return [b"?"]
        self.clock.time_s += self.cycle_s
        if command == 255:
            self.ends += 1
            self.controller.at = self._degrees(self.at)
            return []
        if command == 1:
            assert kind == 2
            point = struct.unpack_from("<4f", data, 8)
            self.set_points.append(self._degrees(point))
            if not self.frozen:
                self.at, self.last = self._followed(self.last or point), point
            if self.lose(len(self.set_points)):
                return []
        return [self._datagram()]

    def _followed(self, now: tuple[float, ...]) -> tuple[float, ...]:
        """Return where the joints are: J2 is later than the others by a part of a cycle."""
        before, self.before = self.before or now, now
        one, two, three, four = now
        return one, two + self.later * (before[1] - two), three, four

    @staticmethod
    def _degrees(axes: tuple[float, ...]) -> tuple[float, ...]:
        return math.degrees(axes[0]), math.degrees(axes[1]), axes[2], math.degrees(axes[3])

    def _datagram(self) -> bytes:
        data = bytearray(196)
        struct.pack_into("<3H", data, 0, 1, 2, 2)
        struct.pack_into("<4f", data, 8, *(self.last or self.at))
        struct.pack_into("<H", data, 108, 8)
        struct.pack_into("<4f", data, 112, *self.at)
        return bytes(data)


@dataclass
class Led:
    """A real-time driver with what stands at its other end."""

    robot: MelfaMxt
    controller: Controller
    port: RealTime
    main: Peer
    aside: Peer
    datagrams: MemoryTransport


@asynccontextmanager
async def led(flags: str = "E0060", **settings: object) -> AsyncIterator[Led]:
    """Connect a real-time driver to a scripted controller and port."""
    controller = Controller()
    controller.flags = flags
    controller.replies["STOP"] = controller.halt
    clock = StepClock()
    port = RealTime(controller, clock)
    async with (
        Peer(controller.answer) as main,
        Peer(controller.answer) as aside,
        Peer(port.answer) as datagrams,
    ):
        checked = MxtSettings.model_validate(
            {**QUICK, "reply_timeout_s": 0.02, "arrival_timeout_s": 0.5, **settings}
        )
        r3 = MelfaR3(main.transport, aside.transport, StepClock(), MelfaSettings.model_validate(QUICK))
        robot = MelfaMxt(r3, SetPointStream(datagrams.transport, clock, checked, name="robot (MXT)"), checked)
        try:
            await robot.connect()
            yield Led(robot, controller, port, main, aside, datagrams.transport)
        finally:
            await robot.close()


async def test_set_points_lead_from_rest_to_rest_through_every_target() -> None:
    async with led() as bench:
        await bench.robot.follow(WAY)
        points = bench.port.set_points
        assert points[-1] == pytest.approx(WAY[-1], abs=1e-4)
        steps = [
            max(abs(two[axis] - one[axis]) for axis in (0, 1, 3)) for one, two in itertools.pairwise(points)
        ]
        # 20 deg/s in cycles of 7.1 ms, and an override of 20 % of 420 deg/s bounds nothing further.
        assert max(steps) <= 20.0 * 0.0071 * 1.001
        assert steps[0] < 0.2 * max(steps)
        await until(lambda: bench.port.ends >= 1)
        assert await bench.robot.joints() == pytest.approx(WAY[-1], abs=1e-4)


async def test_a_controller_with_another_cycle_time_is_refused() -> None:
    """Section 2: 7.1 or 3.5 ms; the same set points would go out at twice the speed."""
    async with led(mxt_cycle_ms=7.1) as bench:
        bench.port.cycle_s = 0.0035
        with pytest.raises(WrongDeviceError, match=r"every 3\.5 ms.*mxt_cycle_ms is 7\.1"):
            await bench.robot.follow(WAY)
        assert bench.port.set_points == []
        await until(lambda: bench.port.ends >= 1)


async def test_the_override_bounds_the_set_points() -> None:
    async with led(full_speed=(10.0, 10.0, 100.0, 10.0)) as bench:
        await bench.robot.follow(WAY)
        points = bench.port.set_points
        fastest = max(abs(two[3] - one[3]) for one, two in itertools.pairwise(points)) / 0.0071
        # STATE of the scripted controller reports an override of 20 %.
        assert fastest == pytest.approx(2.0, rel=0.01)


async def test_single_losses_are_counted_without_repeating_set_points() -> None:
    async with led() as bench:
        bench.port.lose = lambda number: number % 20 == 7
        await bench.robot.follow(WAY)
        on_the_way = [p for p in bench.port.set_points if p != bench.port.set_points[-1]]
        assert len(set(on_the_way)) == len(on_the_way)
        assert "answers to set points were lost" in " ".join(bench.robot.notes)


async def test_an_arrival_of_a_locked_machine_is_none() -> None:
    """Section 1.10: run bit 04. The feedback follows, and the arm has not moved."""
    async with led() as bench:
        bench.controller.flags = "E4060"
        with pytest.raises(NotReadyError, match="machine lock is on"):
            await bench.robot.follow(WAY)


async def test_an_arm_not_following_does_not_arrive() -> None:
    async with led() as bench:
        bench.port.frozen = True
        with pytest.raises(NotArrivedError):
            await bench.robot.follow(WAY)


async def test_lost_answers_while_coming_to_rest_are_tolerated() -> None:
    async with led() as bench:
        at_rest: list[int] = []

        def lose(number: int) -> bool:
            if bench.port.set_points[-1] == pytest.approx(WAY[-1], abs=1e-4):
                at_rest.append(number)
            return len(at_rest) in {2, 3}

        bench.port.lose = lose
        await bench.robot.follow(WAY)
        assert len(at_rest) > 5
        assert not any(b"STOP" in request for request in bench.main.requests + bench.aside.requests)
        assert await bench.robot.joints() == pytest.approx(WAY[-1], abs=1e-4)


async def test_single_garbled_answers_are_losses_like_others() -> None:
    async with led() as bench:
        way = asyncio.create_task(bench.robot.follow(WAY))
        await until(lambda: len(bench.port.set_points) > 20)
        bench.port.garbage = 2
        await way
        assert not any(b"STOP" in request for request in bench.main.requests + bench.aside.requests)
        assert bench.robot.notes[-1] == "2 answers to set points were lost"


async def test_garbage_on_the_real_time_port_is_reported_as_such() -> None:
    async with led() as bench:
        bench.port.garbage = 1000
        with pytest.raises(NotArrivedError, match="an MXT datagram has 196 bytes, this one has 1"):
            await bench.robot.follow(WAY)
        assert bench.port.set_points == []


async def test_only_a_stopped_program_is_started_for_the_path() -> None:
    async with led(flags="A0060") as bench:
        assert not any(b"RUN" in request for request in bench.main.requests)
        await bench.robot.follow(WAY)
        assert b"1;1;RUNCATSMXT;1\r" in bench.main.requests
    async with led() as bench:
        await bench.robot.follow(WAY)
        assert not any(b"RUN" in request for request in bench.main.requests)


async def test_no_set_point_goes_out_once_a_stop_has_begun() -> None:
    async with led() as bench:
        way = asyncio.create_task(bench.robot.follow(((150.0, 0.0, 0.0, 0.0),)))
        await until(lambda: len(bench.port.set_points) > 5)
        sent = len(bench.port.set_points)
        stop = asyncio.create_task(bench.robot.stop())
        with pytest.raises(RefusedError, match="stop overtook"):
            await way
        await stop
        # One may have been on its way.
        assert len(bench.port.set_points) <= sent + 1
        assert bench.port.ends >= 1


async def test_a_path_after_a_failed_one_restarts_the_program() -> None:
    async with led() as bench:
        bench.port.frozen = True
        with pytest.raises(NotArrivedError):
            await bench.robot.follow(WAY)
        assert any(b"STOP" in request for request in bench.main.requests + bench.aside.requests)
        bench.port.frozen = False
        await bench.robot.follow(WAY)
        assert b"1;1;RUNCATSMXT;1\r" in bench.main.requests


async def test_a_port_that_falls_silent_stops_the_arm() -> None:
    async with led() as bench:
        bench.port.lose = lambda number: number > 10
        with pytest.raises(NotArrivedError, match="lost"):
            await bench.robot.follow(WAY)
        assert any(b"STOP" in request for request in bench.main.requests + bench.aside.requests)


async def test_an_alarm_behind_the_silence_is_reported() -> None:
    async with led() as bench:

        def lose(number: int) -> bool:
            if number > 10:
                bench.controller.flags = "80067820"
            return number > 10

        bench.port.lose = lose
        with pytest.raises(AlarmError, match="7820"):
            await bench.robot.follow(WAY)


async def test_a_port_without_a_program_says_what_to_start() -> None:
    async with led() as bench:
        bench.port.deaf = True
        with pytest.raises((LinkTimeoutError, NotArrivedError), match="CATSMXT"):
            await bench.robot.follow(WAY)
        assert bench.port.set_points == []


async def test_a_briefly_refusing_real_time_port_is_retried(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The program closes its port after END and opens it again."""
    async with led(reply_timeout_s=0.005) as bench:
        write = bench.datagrams.write
        refusals = 2

        async def refuse(data: bytes) -> None:
            nonlocal refusals
            refusals -= 1
            if refusals >= 0:
                raise LinkError("a datagram was refused")
            await write(data)

        monkeypatch.setattr(bench.datagrams, "write", refuse)
        await bench.robot.follow(WAY)
        assert bench.port.set_points[-1] == pytest.approx(WAY[-1], abs=1e-4)


async def test_a_cancelled_way_ends_with_stop_and_end() -> None:
    async with led() as bench:
        task = asyncio.create_task(bench.robot.follow(((150.0, 0.0, 0.0, 0.0),)))
        await until(lambda: len(bench.port.set_points) > 5)
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task
        sent = len(bench.port.set_points)
        await asyncio.sleep(0)
        assert len(bench.port.set_points) == sent
        assert any(b"STOP" in request for request in bench.aside.requests)
        assert bench.port.ends >= 1


async def test_a_path_after_a_stop_restarts_the_program() -> None:
    async with led() as bench:
        await bench.robot.stop()
        await bench.robot.follow(WAY)
        assert b"1;1;RUNCATSMXT;1\r" in bench.main.requests


def test_a_missing_real_time_endpoint_is_named() -> None:
    with pytest.raises(LinkError, match="mxt_endpoint"):
        MelfaMxt.at("tcp://127.0.0.1:1", StepClock())


def test_a_driver_more_patient_than_its_controller_is_refused() -> None:
    with pytest.raises(ValidationError, match="one lost answer would be an alarm"):
        MxtSettings(reply_timeout_s=2.0)
    assert MxtSettings(reply_timeout_s=2.0, mxt_timeout_s=-1.0).mxt_timeout_s == -1.0


@pytest.mark.parametrize(("mxttout", "stated"), [("-1", "for ever"), ("71", "0.504 s"), ("1000", "7.1 s")])
async def test_a_real_arm_needs_a_controller_that_gives_up_soon(mxttout: str, stated: str) -> None:
    async with led() as made:
        made.controller.mxttout = mxttout
        with pytest.raises(NotReadyError, match=stated):
            await made.robot.follow(WAY)
        assert made.port.set_points == []
        made.controller.mxttout = "70"
        await made.robot.follow(WAY)


async def test_the_unit_of_the_time_out_can_be_set() -> None:
    async with led(mxt_timeout_unit_ms=1.0) as made:
        made.controller.mxttout = "500"
        await made.robot.follow(WAY)
        assert made.robot.notes == ()


async def test_a_joint_that_follows_later_leads_the_next_way() -> None:
    async with led() as bench:
        bench.port.later = 0.3
        await bench.robot.follow(WAY)
        first, bench.port.set_points = bench.port.set_points, []
        await bench.robot.follow(tuple(reversed(((0.0, 0.0, 5.0, 0.0), *WAY[:-1]))))
        # Both joints go in a fixed ratio when nothing is known, and J2 is ahead once its lag is.
        assert all(two == pytest.approx(2.0 * one, abs=1e-4) for one, two, *_ in first)
        ahead = [2.0 * one - two for one, two, *_ in bench.port.set_points]
        # 20 deg/s are shared 6:12:20 among J1, J2 and J4; 0.3 cycles are 2.13 ms.
        assert max(ahead) == pytest.approx(2.0 * 20.0 / 7.0 * 2.0 * 0.00213, rel=0.2)
        assert bench.port.set_points[-1] == pytest.approx((0.0, 0.0, 5.0, 0.0), abs=1e-4)
        assert bench.robot.notes == ()


async def test_learned_lags_end_with_the_connection() -> None:
    async with led() as bench:
        await bench.robot.follow(WAY)
        assert bench.robot.lags_s[0] == pytest.approx(0.0071, abs=1e-4)
        await bench.robot.close()
        await bench.robot.connect()
        assert bench.robot.lags_s == (None,) * 4


async def test_implausible_lags_are_noted_and_left_alone() -> None:
    async with led(most_lead_ms=1.0) as bench:
        bench.port.later = 0.3
        await bench.robot.follow(WAY)
        assert "up to 2.1 ms one behind the other, more than most_lead_ms = 1" in bench.robot.notes[-1]
        bench.port.set_points.clear()
        await bench.robot.follow(tuple(reversed(((0.0, 0.0, 5.0, 0.0), *WAY[:-1]))))
        assert all(two == pytest.approx(2.0 * one, abs=1e-4) for one, two, *_ in bench.port.set_points)


async def test_learned_lags_are_logged_once(caplog: pytest.LogCaptureFixture) -> None:
    async with led() as bench:
        with caplog.at_level("INFO"):
            await bench.robot.follow(WAY)
            await bench.robot.follow(tuple(reversed(((0.0, 0.0, 5.0, 0.0), *WAY[:-1]))))
    assert len([text for text in caplog.messages if "behind their set points" in text]) == 1
