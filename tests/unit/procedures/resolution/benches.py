"""Benches with optics beside the arm, and a scripted arm that is stepped and looked at."""

import math
from dataclasses import dataclass, field, replace
from typing import ClassVar

from catseye.app.cell.bench import bench_of
from catseye.app.cell.model import Cell
from catseye.drivers.roles.interferometer import LengthReading
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotAbilities
from catseye.procedures.kit.bench import AngularOptics, Bench, LinearOptics
from tests.unit.app.engine.fakes import FakeCounter, FakeRobot
from tests.unit.procedures.six_axes import BENCH

SPACING_MM = 30.0
_WANDER_S = 7.3
OPTICS = AngularOptics(spacing_mm=SPACING_MM, u_spacing_mm=0.01, distance_mm=200.0, signal_min=0.5)
SIX = replace(
    BENCH,
    arm=replace(BENCH.arm, steps=True),
    angular_optics=OPTICS,
    linear_optics=LinearOptics(distance_mm=250.0, signal_min=0.5),
)
"""Six axes of which every one stands clear in the middle of its range."""


def kuka() -> Bench:
    """Return the bench of a KUKA as its cell file describes it."""
    cell = {
        "format": "catseye-cell/1",
        "name": "kuka",
        "robot": {
            "driver": "kuka-varproxy",
            "endpoint": "tcp://127.0.0.1:7000",
            "arm": "kr210-r2700",
            "override_cap_percent": 10.0,
        },
        "angular_optics": {"spacing_mm": SPACING_MM},
        "linear_optics": {},
    }
    return bench_of(Cell.model_validate(cell))


@dataclass
class SteppedArm(FakeRobot):
    """Takes increments and does nine tenths of each; every command takes a second."""

    abilities: ClassVar[RobotAbilities] = RobotAbilities(steps=True)

    steps: list[tuple[str, float]] = field(default_factory=list)
    lines: list[tuple[float, float, float]] = field(default_factory=list)
    targets: list[Pose] = field(default_factory=list)
    torque_nm: float = 40.0

    async def step_axis(self, axis: str, increment: float) -> None:
        self.steps.append((axis, increment))
        number = int(axis[1:]) - 1
        done = tuple(value + 0.9 * increment * (k == number) for k, value in enumerate(self.pose))
        await super().move_joints(done)

    async def step_line(self, increment_mm: tuple[float, float, float]) -> None:
        self.lines.append(increment_mm)
        await super().move_joints(self.pose)

    async def move_joints(self, target: Pose) -> None:
        self.targets.append(target)
        await super().move_joints(target)

    async def torques(self) -> tuple[float, ...]:
        return (self.torque_nm,) * 6


@dataclass
class AngleCounter(FakeCounter):
    """Counts S sin θ of the first axis, from its zero.

    Attributes:
        arm: that carries the retroreflector.
        dark: after so many steps something passes through the beam, once for each number.
        wander_mm: amplitude of what the air adds, with a period of some seconds.
    """

    arm: SteppedArm = field(kw_only=True)
    dark: set[int] = field(default_factory=set)
    zero_deg: float = 0.0
    wander_mm: float = 0.0

    async def zero(self) -> int:
        self.zero_deg = self.arm.pose[0]
        self.beam = replace(self.beam, beam_lost=False)
        return await super().zero()

    async def read(self) -> LengthReading:
        steps = len(self.arm.steps)
        if steps in self.dark:
            self.dark.discard(steps)
            self.beam = replace(self.beam, beam_lost=True)
        turned = math.radians(self.arm.pose[0] - self.zero_deg)
        now_s = self.clock.monotonic_s()
        air_mm = self.wander_mm * math.sin(2.0 * math.pi * now_s / _WANDER_S)
        return LengthReading(SPACING_MM * math.sin(turned) + air_mm, "", now_s)
