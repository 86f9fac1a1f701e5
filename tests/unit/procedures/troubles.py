"""An ideal arm on a bench where more can go wrong: what a count, a hand or a laser do to a measurement."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace

from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Pose
from catseye.procedures.kit.context import Measurement
from catseye.procedures.kit.errors import ArmMovedError, NoBeamError
from tests.unit.procedures.benches import IdealContext, arm_xy


@dataclass
class TroubledContext(IdealContext):
    """A context with troubles.

    Attributes:
        breaks_on_move: numbers of moves, from 1, on which something passes through the beam.
        fast_on_move: numbers of moves on which the length changes faster than the counter counts.
        refused_zeros: numbers of zeros, from 1, at which the beam is away for a moment.
        laser_off_at: numbers of measurements during which the laser is not ready.
        before_measuring: called with the number of each measurement before it is taken.
        before_joints: called with the number of each look at the joints.
        moved_on_way: numbers of moves during which the run is held and somebody moves the arm.
        grown_mm: what the beam has grown by.
        gaussian: the signal falls with the miss, as exp(-2 (miss / acceptance)²).
    """

    breaks_on_move: set[int] = field(default_factory=set)
    fast_on_move: set[int] = field(default_factory=set)
    refused_zeros: set[int] = field(default_factory=set)
    laser_off_at: set[int] = field(default_factory=set)
    before_measuring: Callable[[int], None] = lambda _number: None
    before_joints: Callable[[int], None] = lambda _number: None
    moved_on_way: set[int] = field(default_factory=set)
    grown_mm: float = 0.0
    gaussian: bool = False
    overspeed: bool = False
    tried_zeros: int = 0
    looks: int = 0

    def length_mm(self) -> float | None:
        """Return the length of the beam with what it has grown by."""
        length = super().length_mm()
        return None if length is None else length + self.grown_mm

    async def move(self, target: Pose) -> None:
        """Move, with what happens on the way."""
        await super().move(target)
        if len(self.moves) in self.breaks_on_move:
            self.lost = True
        if len(self.moves) in self.fast_on_move:
            self.overspeed = True
        if len(self.moves) in self.moved_on_way:
            self.pose = (-30.0, 33.0, 12.5, 10.0)
            self.lost = True
            raise ArmMovedError("moved by hand")

    async def zero(self, dead_path_mm: float) -> None:
        """Zero, unless the beam is away just now."""
        self.tried_zeros += 1
        if self.tried_zeros in self.refused_zeros:
            raise NoBeamError("no zero without a beam")
        await super().zero(dead_path_mm)
        self.overspeed = False

    async def joints(self) -> Pose:
        """Return where the arm stands now."""
        self.looks += 1
        self.before_joints(self.looks)
        return await super().joints()

    async def measure(self, settle_time_s: float, dwell_time_s: float, readings: int) -> Measurement:
        """Measure, with what goes wrong meanwhile."""
        self.before_measuring(self.measurements + 1)
        if self.length_mm() is None:
            self.lost = True
        measured = await super().measure(settle_time_s, dwell_time_s, readings)
        ready = self.measurements not in self.laser_off_at
        if not ready:
            self.lost = True
        status = replace(measured.beam, beam_lost=self.lost, laser_ready=ready, overspeed=self.overspeed)
        return replace(measured, beam=replace(status, signal=self.level() if status.count_valid else 0.0))

    async def beam(self) -> BeamStatus:
        """Return the state of the beam."""
        there = self.length_mm() is not None
        return BeamStatus(
            there, self.lost, self.overspeed, laser_ready=True, signal=self.level() if there else 0.0
        )

    def level(self) -> float:
        """Return the level of the returning beam."""
        if not self.gaussian:
            return 0.75
        one, two, _, four = self.pose
        x, y = arm_xy(one, two)
        world = math.radians(one + two + four + self.theta40_deg + self.j4_error_deg(one, two))
        misses = [
            abs((py - y) * math.cos(world) - (px - x) * math.sin(world)) for px, py in self.places.values()
        ]
        return math.exp(-2.0 * (min(misses) / self.acceptance_mm) ** 2)
