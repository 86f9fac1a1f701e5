"""Orders to a program of ours on a controller, in front of one that is made up."""

import asyncio
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import pytest

from catseye.drivers.links.beating import Beat
from catseye.drivers.links.guarding import UNGUARDED, GuardError, Unguarded
from catseye.drivers.links.motions import Motion
from catseye.drivers.links.orders import NumberedOrders, OrderLook, OrderRefusedError
from catseye.drivers.links.stops import Stops, StopWatch
from catseye.drivers.roles.clock import Clock, SystemClock
from catseye.drivers.roles.errors import (
    DeviceError,
    LinkError,
    LinkTimeoutError,
    NotArrivedError,
    ProtocolError,
    RefusedError,
)
from tests.unit.drivers.virtual_time import VirtualClock, run

DONE, REFUSED, ENDED_EARLY = 0, 1, 2


@dataclass(frozen=True)
class Times:
    answer_timeout_s: float = 0.5
    taken_timeout_s: float = 1.0
    move_timeout_s: float = 10.0
    heartbeat_s: float = 0.01
    poll_s: float = 0.001


class MadeUp(NumberedOrders):
    """A program that takes every order at once and ends it with a result, or fails with an error."""

    def __init__(self, ending: int | Exception, clock: Clock | None = None) -> None:
        super().__init__("robot", "PROGRAM", "start it", clock or SystemClock(), Times())
        self.ending = ending
        self.silent: set[str] = set()
        self.written = 0
        self.looks = 0
        self.beats = 0
        self.answered = asyncio.Event()
        self.answered.set()

    async def heard(self, question: str) -> None:
        """Wait for ever for an answer that does not come."""
        if question in self.silent:
            await asyncio.get_running_loop().create_future()

    async def look(self) -> OrderLook:
        await self.heard("taken" if self.looks == 0 else "done")
        self.looks += 1
        if isinstance(self.ending, Exception):
            await asyncio.sleep(0)
            raise self.ending
        return OrderLook(True, "running", self.written, self.written, self.ending)

    async def _write_number(self, number: int, permit: Callable[[], None]) -> None:
        permit()
        self.written = number
        if "written" in self.silent:
            raise LinkTimeoutError("no answer")

    async def _written_number(self) -> int:
        await self.heard("written")
        return self.written

    async def _take_back(self) -> None:
        pass

    def _beats(self, permit: Callable[[], None]) -> Sequence[Beat]:
        return (partial(self._beat, permit),)

    async def _beat(self, permit: Callable[[], None]) -> None:
        permit()
        self.beats += 1
        await self.answered.wait()

    def _require_done(self, result: int) -> None:
        if result == REFUSED:
            raise OrderRefusedError("refused", result)
        if result == ENDED_EARLY:
            raise NotArrivedError("ended early")


@dataclass
class Arm:
    """What stops."""

    orders: MadeUp
    stops: Stops = field(default_factory=Stops)
    beats_at_stop: int = -1
    stopped_s: float = -1.0
    unconfirmed: str = ""

    @property
    def motion(self) -> Motion:
        return Motion(StopWatch(self.stops, "robot"), UNGUARDED, self.stop)

    async def stop(self) -> None:
        with self.stops.one():
            self.beats_at_stop = self.orders.beats
            self.stopped_s = asyncio.get_running_loop().time()
            await asyncio.sleep(0.05)
            # A sign of life whose answer is awaited yet.
            self.orders.answered.set()
            if self.unconfirmed:
                raise LinkError(self.unconfirmed)


async def failure_of(arm: Arm) -> Exception:
    with pytest.raises((DeviceError, OSError)) as caught:
        async with asyncio.timeout(5.0):
            await arm.orders.carry_out(1, arm.motion)
    return caught.value


@pytest.mark.parametrize(
    "error", [RefusedError("503", 0), LinkError("lost"), ProtocolError("garbage"), OSError("anything else")]
)
async def test_whatever_fails_stops_the_arm(error: Exception) -> None:
    arm = Arm(MadeUp(error))
    assert await failure_of(arm) is error
    assert arm.stops.begun == 1


async def test_stop_waits_for_no_sign_of_life() -> None:
    arm = Arm(MadeUp(LinkError("lost")))
    arm.orders.answered.clear()
    await failure_of(arm)
    assert arm.stops.begun == 1


async def test_no_sign_of_life_follows_the_beginning_of_a_stop() -> None:
    arm = Arm(MadeUp(LinkError("lost")))
    await failure_of(arm)
    assert arm.orders.beats == arm.beats_at_stop


async def test_an_order_that_ended_early_stops_the_arm() -> None:
    arm = Arm(MadeUp(ENDED_EARLY))
    assert isinstance(await failure_of(arm), NotArrivedError)
    assert arm.stops.begun == 1


async def test_a_refused_order_stops_nothing() -> None:
    arm = Arm(MadeUp(REFUSED))
    assert isinstance(await failure_of(arm), OrderRefusedError)
    assert arm.stops.begun == 0


async def test_a_failure_by_a_stop_is_called_so() -> None:
    arm = Arm(MadeUp(LinkError("out of step")))
    motion = arm.motion
    with arm.stops.one(), pytest.raises(RefusedError, match="a stop overtook"):
        await arm.orders.carry_out(1, motion)
    assert arm.stops.begun == 1


@pytest.mark.parametrize("question", ["written", "taken", "done"])
def test_an_arm_nobody_sees_is_stopped_soon(question: str) -> None:
    arm = Arm(MadeUp(DONE, VirtualClock()))
    arm.orders.silent = {question}
    error = run(failure_of(arm))
    assert isinstance(error, LinkTimeoutError)
    # An answer of 0.5 s, and a second to heal the connection.
    assert arm.stopped_s == pytest.approx(1.5, abs=0.01)
    assert arm.orders.beats == arm.beats_at_stop


def test_looks_that_succeed_now_and_then_go_on() -> None:
    class Slow(MadeUp):
        async def look(self) -> OrderLook:
            await asyncio.sleep(0.4)
            self.looks += 1
            return OrderLook(True, "running", 1, int(self.looks == 3), DONE)

    arm = Arm(Slow(DONE, VirtualClock()))
    run(arm.orders.carry_out(1, arm.motion))
    assert arm.stops.begun == 0


@pytest.mark.parametrize("guard", ["holds", "tripped"])
async def test_an_unconfirmed_stop_stands_in_the_error(guard: str) -> None:
    arm = Arm(MadeUp(LinkError("lost")), unconfirmed="PRESS THE EMERGENCY STOP")
    arm.orders.written = 1
    motion = arm.motion if guard == "holds" else replace(arm.motion, guard=Tripped())
    expected = r"(lost|the guard has stopped the arm); PRESS THE EMERGENCY STOP"
    with pytest.raises(DeviceError, match=expected):
        await arm.orders.carry_out(1, motion)


class Tripped(Unguarded):
    """A guard that has stopped the arm."""

    def permit(self) -> None:
        raise GuardError("the guard has stopped the arm")


async def test_a_failure_by_the_guards_stop_is_called_so() -> None:
    arm = Arm(MadeUp(LinkError("the program stands")))
    motion = replace(arm.motion, guard=Tripped())
    arm.orders.written = 1
    with pytest.raises(GuardError, match="the guard has stopped the arm"):
        await arm.orders.carry_out(1, motion)
    assert arm.stops.begun == 1
