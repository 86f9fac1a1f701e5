"""An arm in virtual time that can be moved by hand, and a bench around it."""

import asyncio
from collections.abc import AsyncIterator, Mapping
from contextlib import asynccontextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, ClassVar, Literal, cast

from catseye.app.cell.bench import scara_bench_of
from catseye.app.cell.model import Cell
from catseye.app.engine.devices import Devices
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.message import JsonObject
from catseye.app.service.manual.device_loan import ManualBench
from catseye.app.service.watching.bench_facts import BenchFacts, DeviceFacts
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import DeviceError, RefusedError
from catseye.drivers.roles.io import Io, Light
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import Robot, RobotAbilities, RobotStatus
from tests.unit.app.guard.fakes import FakeGuard
from tests.unit.drivers.virtual_time import VirtualClock

HOME: Pose = (0.0, 0.0, 50.0, 0.0)
AXES = ("J1", "J2", "J3", "J4")
DEAD_MAN_S = 0.14
COASTS_S = 0.03
"""How long the arm goes on after a stop, at its speed."""


@dataclass
class Feed:
    """What a jog of this arm is fed through."""

    arm: "TimedArm"
    until_s: float = 0.0

    def feed(self) -> None:
        self.arm.settle()
        self.until_s = self.arm.now_s + 0.2 + DEAD_MAN_S


@dataclass
class TimedArm(Robot):
    """An arm whose joints turn at one speed; `log` has times and what was asked of it."""

    abilities: ClassVar[RobotAbilities] = RobotAbilities(jogs=True)

    speed_deg_s: float = 10.0
    answer_s: float = 0.01
    pose: Pose = HOME
    state: RobotStatus = field(
        default_factory=lambda: RobotStatus(False, False, True, False, False, 100.0, 0, "")
    )
    simulated: bool = True
    log: list[tuple[float, str]] = field(default_factory=list)
    servo_error: DeviceError | None = None
    runs_away: bool = False
    driven: tuple[float, ...] = (0.0, 0.0, 0.0, 0.0)
    feed: Feed | None = None
    settled_s: float = 0.0
    until_s: float = 0.0
    stops: int = 0
    began_at_percent: list[float] = field(default_factory=list)

    @property
    def now_s(self) -> float:
        return asyncio.get_running_loop().time()

    def said(self, *words: str) -> list[str]:
        """Return what was asked of it, of these kinds."""
        return [text for _, text in self.log if text.split()[0] in words]

    def note(self, text: str) -> None:
        self.log.append((self.now_s, text))

    def settle(self) -> None:
        """Bring the joints to where they are now."""
        now_s = self.now_s
        until_s = min(now_s, self.until_s if self.feed is None else min(self.until_s, self.feed.until_s))
        if self.runs_away:
            until_s = now_s
        moved_s = max(0.0, until_s - self.settled_s)
        at = [here + rate * moved_s for here, rate in zip(self.pose, self.driven, strict=True)]
        self.pose, self.settled_s = (at[0], at[1], at[2], at[3]), now_s

    @property
    def moving(self) -> bool:
        end_s = self.until_s if self.feed is None else min(self.until_s, self.feed.until_s)
        return any(self.driven) and (self.runs_away or self.now_s < end_s)

    async def connect(self) -> Identity:
        return Identity("timed", "1.0", "7", self.simulated)

    async def close(self) -> None:
        self.note("close")

    async def status(self) -> RobotStatus:
        await asyncio.sleep(self.answer_s)
        return replace(self.state, running=self.moving)

    async def servo(self, *, on: bool) -> None:
        await asyncio.sleep(self.answer_s)
        self.note(f"servo {'on' if on else 'off'}")
        if self.servo_error:
            raise self.servo_error
        self.settle()
        self.state = replace(self.state, servo_on=on)
        if not on:
            self.driven, self.runs_away = (0.0, 0.0, 0.0, 0.0), False

    async def set_override(self, percent: float) -> float:
        # Noted when it is sent: a stop may come before its answer.
        self.note(f"override {percent:g}")
        await asyncio.sleep(self.answer_s)
        self.state = replace(self.state, override_percent=percent)
        return percent

    async def joints(self) -> Pose:
        await asyncio.sleep(self.answer_s)
        self.settle()
        return self.pose

    async def move_joints(self, target: Pose) -> None:
        self.settle()
        self.began_at_percent.append(self.state.override_percent)
        self.note("move " + " ".join(f"{value:.4f}" for value in target))
        way = [to - at for at, to in zip(self.pose, target, strict=True)]
        duration_s = max(map(abs, way)) / self.speed_deg_s
        if duration_s == 0.0:
            return
        stops = self.stops
        self.feed, self.until_s = None, self.now_s + duration_s
        self.driven = tuple(part / duration_s for part in way)
        try:
            while self.moving and self.stops == stops:  # noqa: ASYNC110  # time alone moves this arm
                await asyncio.sleep(min(0.01, max(0.0, self.until_s - self.now_s)))
        except asyncio.CancelledError:
            await self.stop()
            raise
        if self.stops > stops:
            raise RefusedError("a stop overtook the motion", 5610)
        self.settle()
        self.pose = target

    @asynccontextmanager
    async def jogging(self, directions: Mapping[str, Literal[-1, 1]]) -> AsyncIterator[Feed]:
        self.settle()
        self.began_at_percent.append(self.state.override_percent)
        self.note("jog " + " ".join(f"{joint}{way:+d}" for joint, way in directions.items()))
        self.driven = tuple(self.speed_deg_s * directions.get(axis, 0) for axis in AXES)
        self.feed, self.until_s = Feed(self), float("inf")
        try:
            yield self.feed
        finally:
            await self.stop()

    async def stop(self) -> None:
        self.note("stop")
        self.settle()
        self.stops += 1
        self.until_s = min(self.until_s, self.now_s + COASTS_S)
        await asyncio.sleep(2 * COASTS_S)


class StepsOnlyArm(TimedArm):
    """An arm whose driver knows no jog of its own."""

    abilities: ClassVar[RobotAbilities] = RobotAbilities()


@dataclass
class Door(Io):
    """A door that tests open."""

    closed: bool = True

    async def connect(self) -> Identity:
        return Identity("door", "1.0", "8", True)

    async def close(self) -> None:
        """Nothing is open."""

    async def door_closed(self) -> bool:
        await asyncio.sleep(0)
        return self.closed

    async def show(self, light: Light) -> None:
        """There are no lamps."""


class ManualFixture:
    """Everything that moving by hand needs, around one arm."""

    def __init__(self, cell: Cell, arm: TimedArm) -> None:
        self.arm = arm
        self.door = Door()
        self.guard = FakeGuard()
        self.robot: Any = arm
        self.robots: dict[str, Any] = {"robot": arm}
        self.announced: list[JsonObject] = []
        self.wire: list[tuple[str, str, bytes]] = []
        self.acquired_now = False
        self.owned_for: list[str] = []
        self.detached_now: list[str] = []
        self.acquire_error: Exception | None = None
        self.facts_now = BenchFacts(
            cell.name,
            (
                DeviceFacts("robot", "memory://robot", "melfa-r3"),
                DeviceFacts("interferometer", "memory://counter", "line-counter"),
            ),
            scara_bench_of(cell),
            cell.robot.override_cap_percent,
            TimedArm.abilities,
            cell.air,
            None,
        )
        self.bench = ManualBench(
            self,
            self._facts,
            self._identities,
            self._record,
            self._announce,
            VirtualClock(),
            Path(),
            lambda: self.door,
            self.owned,
        )

    @asynccontextmanager
    async def owned(self, what: str) -> AsyncIterator[None]:
        self.owned_for.append(what)
        yield

    @asynccontextmanager
    async def acquired(self) -> AsyncIterator[Devices]:
        if self.acquire_error:
            raise self.acquire_error
        self.acquired_now = True
        try:
            await asyncio.sleep(0)
            none = cast(Any, None)
            yield Devices(self.robot, none, none, io=self.door, guard=self.guard)
        finally:
            self.acquired_now = False

    @asynccontextmanager
    async def acquired_robot(self, device: str) -> AsyncIterator[Any]:
        if self.acquire_error:
            raise self.acquire_error
        yield self.robots[device]

    @asynccontextmanager
    async def detached(self, device: str) -> AsyncIterator[None]:
        self.detached_now.append(device)
        try:
            yield
        finally:
            self.detached_now.remove(device)

    def events(self, name: str) -> list[JsonObject]:
        return [event for event in self.announced if event["event"] == name]

    async def _facts(self) -> BenchFacts:
        return self.facts_now

    def _identities(self) -> dict[str, Identity]:
        return {"robot": Identity("timed", "1.0", "7", self.arm.simulated)}

    def _record(self, device: str, direction: str, data: bytes) -> None:
        self.wire.append((device, direction, data))

    def _announce(self, event: AnyEvent) -> None:
        self.announced.append(event.json_object())
