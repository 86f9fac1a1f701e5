"""Scripted instruments, a manual clock and a bench around them."""

import asyncio
from collections.abc import Awaitable, Callable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, ClassVar

from catseye.app.engine.devices import Devices, WireRecorder
from catseye.app.engine.halt import HaltLimits
from catseye.app.engine.request import RunRequest
from catseye.app.protocol.run_events import RunEvent
from catseye.drivers.roles.air import AirSample, AirSensor
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.interferometer import BeamStatus, Compensated, Interferometer, LengthReading
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import Robot, RobotAbilities, RobotStatus
from catseye.procedures.kit.bench import Arm
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.records import Json, Record, Row
from catseye.procedures.scara.records import Distance
from tests.unit.procedures.benches import scara_axes

ARM = Arm(
    scara_axes(j3_mm=(0.0, 150.0)),
    ("limits_deg.j1", "limits_deg.j2", "j3_mm or j3_range_mm", "limits_deg.j4"),
    20.0,
)
HOME: Pose = (0.0, 0.0, 0.0, 0.0)
AWAY: Pose = (10.0, 20.0, 0.0, 30.0)

_SHORT_S = 0.99


def free_way(_way: Sequence[Pose]) -> str | None:
    """Let every motion pass: what bodies do is shown elsewhere."""
    return None


def straight(here: Pose, shift_mm: tuple[float, float, float]) -> Pose:
    """Take the first three axes for those of the base frame."""
    moved = tuple(value + shift for value, shift in zip(here[:3], shift_mm, strict=True))
    return (*moved, *here[3:])


class ManualClock:
    """Short sleeps pass at once and move the time on; long ones, the deadlines, wait until it has come."""

    def __init__(self) -> None:
        self.time_s = 0.0
        self._sleepers: list[tuple[float, asyncio.Event]] = []

    def monotonic_s(self) -> float:
        return self.time_s

    def now_utc(self) -> datetime:
        return datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC) + timedelta(seconds=self.time_s)

    def advance(self, duration_s: float) -> None:
        self.time_s += duration_s
        for due_s, event in self._sleepers:
            if due_s <= self.time_s:
                event.set()

    async def sleep(self, duration_s: float) -> None:
        if duration_s <= _SHORT_S:
            self.advance(duration_s)
            await asyncio.sleep(0)
            return
        event = asyncio.Event()
        self._sleepers.append((self.time_s + duration_s, event))
        await event.wait()


def identity(simulated: bool) -> Identity:
    return Identity("fake", "1.0", "7", simulated)


@dataclass
class FakeRobot(Robot):
    """Moves in one second of the clock, or not before it is released.

    Attributes:
        off: by which every axis is read back beside where it stands.
    """

    abilities: ClassVar[RobotAbilities] = RobotAbilities()

    clock: ManualClock
    calls: list[str] = field(default_factory=list)
    simulated: bool = True
    pose: Pose = HOME
    off: float = 0.0
    read_back_limit: float = 0.0
    state: RobotStatus = field(
        default_factory=lambda: RobotStatus(False, False, True, False, False, 100.0, 0, "")
    )
    overrides: list[float] = field(default_factory=list)
    connect_error: DeviceError | None = None
    move_error: Exception | None = None
    stop_error: DeviceError | None = None
    blocks: bool = False
    ignores_stop: bool = False
    creeps: bool = False
    moving: asyncio.Event = field(default_factory=asyncio.Event)

    async def connect(self) -> Identity:
        self.calls.append("connect")
        if self.connect_error:
            raise self.connect_error
        return identity(self.simulated)

    async def close(self) -> None:
        self.calls.append("close")

    async def status(self) -> RobotStatus:
        await asyncio.sleep(0)
        return self.state

    async def servo(self, *, on: bool) -> None:
        self.calls.append(f"servo {'on' if on else 'off'}")
        self.state = replace(self.state, servo_on=on, running=self.state.running and on)

    def without_right(self) -> RobotStatus:
        return replace(self.state, operation_enabled=False)

    async def set_override(self, percent: float) -> float:
        self.calls.append(f"override {percent:g}")
        read_back = self.overrides.pop(0) if self.overrides else percent
        self.state = replace(self.state, override_percent=read_back)
        return read_back

    async def move_joints(self, target: Pose) -> None:
        self.calls.append("move")
        self.state = replace(self.state, running=True)
        if self.move_error:
            raise self.move_error
        self.moving.set()
        try:
            if self.blocks:
                await asyncio.Event().wait()
        except asyncio.CancelledError:
            self.calls.append("move cancelled")
            raise
        self.clock.advance(1.0)
        self.pose = target
        self.state = replace(self.state, running=False)

    async def joints(self) -> Pose:
        if self.creeps and self.state.servo_on:
            self.pose = (self.pose[0] + 0.5, *self.pose[1:])
        return tuple(value + self.off for value in self.pose) if self.off else self.pose

    async def stop(self) -> None:
        self.calls.append("stop")
        if self.stop_error:
            raise self.stop_error
        if not self.ignores_stop:
            self.state = replace(self.state, running=False)


@dataclass
class FakeCounter(Interferometer):
    """Counts up by a micrometre a reading."""

    clock: ManualClock
    simulated: bool = True
    connect_error: DeviceError | None = None
    beam: BeamStatus = field(default_factory=lambda: BeamStatus(True, False, False, True, 0.8))
    count: int = 0
    zeros: int = 0
    compensated: Compensated = "instrument"

    async def connect(self) -> Identity:
        if self.connect_error:
            raise self.connect_error
        return identity(self.simulated)

    async def close(self) -> None:
        """Nothing is open."""

    async def zero(self) -> int:
        self.zeros += 1
        return self.zeros

    async def read(self) -> LengthReading:
        self.count += 1
        return LengthReading(self.count * 1e-3, "", self.clock.monotonic_s())

    async def status(self) -> BeamStatus:
        return self.beam


@dataclass
class FakeAir(AirSensor):
    """Gives one state of the air and counts how often."""

    clock: ManualClock
    simulated: bool = True
    connect_error: DeviceError | None = None
    samples: int = 0
    pressure_hpa: float | None = 1013.0

    async def connect(self) -> Identity:
        if self.connect_error:
            raise self.connect_error
        return identity(self.simulated)

    async def close(self) -> None:
        """Nothing is open."""

    async def sample(self) -> AirSample:
        self.samples += 1
        return AirSample(20.0 + self.samples, self.pressure_hpa, 50.0, self.clock.monotonic_s())


class Script:
    """A procedure made of a function."""

    name = "script"
    title = "Scripted procedure"
    records: ClassVar[tuple[type[Record], ...]] = (Distance,)
    sets_up_anew = False

    def __init__(
        self,
        body: Callable[[Context], Awaitable[None]],
        teardown: Callable[[Context], Awaitable[None]] | None = None,
    ) -> None:
        self._body = body
        self._teardown = teardown
        self.torn_down = 0

    async def run(self, ctx: Context, plan: object) -> None:
        del plan
        await self._body(ctx)

    async def teardown(self, ctx: Context) -> None:
        self.torn_down += 1
        if self._teardown is not None:
            await self._teardown(ctx)


@dataclass
class FakeBench:
    """Everything a run needs."""

    root: Path
    clock: ManualClock = field(default_factory=ManualClock)
    published: list[dict[str, Json]] = field(default_factory=list)
    signal: Callable[[int], None] = lambda _number: None

    def __post_init__(self) -> None:
        self.robot = FakeRobot(self.clock)
        self.counter = FakeCounter(self.clock)
        self.air = FakeAir(self.clock)

    def make_real(self) -> None:
        self.robot.simulated = self.counter.simulated = self.air.simulated = False

    def build(self, record: WireRecorder) -> Devices:
        record("robot", "tx", b"hello\r")
        return Devices(self.robot, self.counter, self.air)

    def publish(self, event: RunEvent) -> None:
        self.published.append(event.json_object())

    def install(self, on_signal: Callable[[int], None]) -> AbstractContextManager[None]:
        @contextmanager
        def installed() -> Iterator[None]:
            self.signal = on_signal
            yield

        return installed()

    def request(self, procedure: Script, **changes: Any) -> RunRequest:
        request = RunRequest(
            procedure=procedure,
            plan=None,
            root=self.root,
            cell="lab-1",
            driven=ARM,
            blocked=free_way,
            line_target=straight,
            override_cap_percent=20.0,
            reserve_bytes=0,
            halt_limits=HaltLimits(standstill_s=0.5),
        )
        return replace(request, **changes)

    def said(self, event: str) -> list[dict[str, Json]]:
        return [entry for entry in self.published if entry["event"] == event]

    def states(self) -> list[Json]:
        states = [entry["state"] for entry in self.said("state")]
        return [state for number, state in enumerate(states) if number == 0 or states[number - 1] != state]


def distance(number: int = 0, **changes: Any) -> Distance:
    values: dict[str, Any] = {**point(number), **changes}
    return Distance(**values)


def point(number: int = 0) -> Row:
    return {
        "reflector": "P1",
        "segment": 0,
        "theta1_deg": 1.0 * number,
        "theta2_deg": 2.0,
        "j3_mm": 0.0,
        "j4_deg": 3.0,
        "reported1_deg": 1.0,
        "reported2_deg": 2.0,
        "reported3_mm": 0.0,
        "reported4_deg": 3.0,
        "direction1": 1,
        "direction2": -1,
        "displacement_mm": 0.1,
        "spread_mm": 0.0,
        "readings": 5,
        "signal": 0.9,
        "temperature_c": 20.0,
        "pressure_hpa": None,
        "humidity_percent": 50.0,
        "time_utc": "2026-01-02T03:04:05+00:00",
        "duration_s": 0.5,
    }
