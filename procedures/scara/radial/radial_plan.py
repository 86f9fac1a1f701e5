"""Over which arc J1 and J2 turn by themselves, and where an indicator reads the artefact on their axis."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Final, Literal

import numpy as np

from catseye.calibration.standards.error_motion import FEWEST_PLACES, Gauging
from catseye.drivers.roles.pose import Pose, with_axis
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.kit.motion.clear_way import clear_poses, way_refusal
from catseye.procedures.kit.motion.motion_time import way_time_s
from catseye.procedures.scara.bench import ScaraBench

Joint = Literal["J1", "J2"]
Direction = Literal["x", "y"]

NUMBERS: Final[dict[Joint, int]] = {"J1": 0, "J2": 1}
"""Place of a joint in a pose."""

WHOLE_DEG: Final = 240.0
"""Over a shorter arc the centre of the circle takes more than a tenth of the rms of a smooth error motion with it."""

_SHORTEST_DEG: Final = 90.0
_LOOK_DEG: Final = 2.0
"""Between two poses that are looked at for what stands in the way; the whole way is checked then."""

_HAND_S: Final = 8.0
_FILE_S: Final = 60.0
"""Expected time in which somebody reads an indicator and types it."""

_MOUNTING_S: Final = 300.0
"""Expected time in which artefact and indicator are mounted and centred."""


@dataclass(frozen=True)
class Sweep:
    """A joint that turns by itself.

    Attributes:
        joint: its name.
        standing: pose of the others; this joint's value counts for nothing.
        values_deg: where the artefact is read, upwards.
        take_up_deg: by which the joint goes beyond the ends, so that every place is come to from one side.
    """

    joint: Joint
    standing: Pose
    values_deg: tuple[float, ...]
    take_up_deg: float

    def pose(self, value_deg: float) -> Pose:
        """Return the pose with the joint at a value."""
        return with_axis(self.standing, NUMBERS[self.joint], value_deg)

    def before(self, value_deg: float, approach: int) -> Pose:
        """Return the pose from which a value is come to upwards (1) or downwards (-1)."""
        return self.pose(value_deg - approach * self.take_up_deg)

    def order(self, approach: int) -> tuple[float, ...]:
        """Return the values as they are come to."""
        return self.values_deg if approach > 0 else self.values_deg[::-1]

    def after(self, angle_deg: float, approach: int) -> Pose:
        """Return where the joint goes from a place of a cycle: to the next one, or to where it turns back."""
        order = self.order(approach)
        place = order.index(angle_deg)
        return self.pose(order[place + 1]) if place + 1 < len(order) else self.before(angle_deg, -approach)

    @property
    def start(self) -> Pose:
        """Where a cycle begins and ends."""
        return self.before(self.values_deg[0], 1)

    @property
    def way(self) -> tuple[Pose, ...]:
        """Every pose of a cycle, in order."""
        up, down = (tuple(map(self.pose, self.order(approach))) for approach in (1, -1))
        return (self.start, *up, self.before(self.values_deg[-1], -1), *down, self.start)

    @property
    def arc_deg(self) -> float:
        """From the first place to the last."""
        return self.values_deg[-1] - self.values_deg[0]


@dataclass(frozen=True)
class Reading:
    """Cycles with indicators in the same directions.

    Attributes:
        sweep: of the joint.
        turned: the artefact is turned by half a turn against the joint, the indicators stand on the other side.
        directions: in which they read.
        mounted: the artefact is mounted anew before them.
    """

    sweep: Sweep
    turned: bool
    directions: tuple[Direction, ...]
    mounted: bool

    @property
    def mounting(self) -> str:
        """What it is called in the names of steps and questions."""
        return f"{self.sweep.joint}/{'turned' if self.turned else 'direct'}"


@dataclass(frozen=True)
class RadialPlan:
    """A whole measurement.

    Attributes:
        bench: what it was made from.
        readings: in order.
        cycles: of each.
        settle_s: standstill before a reading.
        within_um: largest accepted eccentricity of the artefact.
        gauging: what is known of indicator and artefact.
        recorded_s: how long the joint stands still at each place for the indicator's own program, whose file is read
            after each cycle; None where a person types the readings.
    """

    bench: ScaraBench
    readings: tuple[Reading, ...]
    cycles: int
    settle_s: float
    within_um: float
    gauging: Gauging
    recorded_s: float | None = None

    def cycle_s(self, reading: Reading) -> float:
        """Return the expected time of a cycle, s."""
        places = 2 * len(reading.sweep.values_deg)
        way_s = way_time_s(self.bench.arm, np.array(reading.sweep.way))
        if self.recorded_s is not None:
            return way_s + places * (self.settle_s + self.recorded_s) + _FILE_S * len(reading.directions)
        return way_s + places * (self.settle_s + _HAND_S * len(reading.directions))

    @property
    def duration_s(self) -> float:
        """Expected time of everything, hands included, s."""
        mounting_s = _MOUNTING_S * sum(reading.mounted for reading in self.readings)
        return mounting_s + self.cycles * sum(map(self.cycle_s, self.readings))


def sweep_of(bench: ScaraBench, joint: Joint, given_deg: list[float], step_deg: float) -> Sweep:
    """Return the arc over which a joint is measured: as asked for, or the largest that is clear.

    Args:
        given_deg: its ends; as far as the joint turns clear where empty.

    Raises:
        PlanError: the arc is too short, or something stands in the way.
    """
    fewest_deg = max(_SHORTEST_DEG, (FEWEST_PLACES - 1) * step_deg)
    found = list(_asked(bench, joint, given_deg) if given_deg else _clear_arcs(bench, joint))
    # Of equal arcs the one on which the arm reaches least far: it is folded, or near the middle of its nodes.
    found.sort(key=lambda each: (round(each[2] - each[1]), -_reach(bench, joint, each[0])), reverse=True)
    refusal = ""
    for standing, low, high in found:
        if high - low < fewest_deg - 1e-9:
            break
        places = int((high - low) / step_deg + 1e-9) + 1
        start = low + 0.5 * (high - low - (places - 1) * step_deg)
        values = tuple(round(start + number * step_deg, 3) for number in range(places))
        sweep = Sweep(joint, standing, values, bench.take_up_deg)
        if (blocked := way_refusal(sweep.way, bench)) is None:
            return sweep
        refusal = refusal or f": {blocked}"
    raise PlanError(
        f"{joint} cannot turn through {fewest_deg:g}° and {bench.take_up_deg:g}° beyond either end, which steps of "
        f"{step_deg:g}° need{refusal or ': widen its limits, or make step_deg smaller'}"
    )


def _asked(bench: ScaraBench, joint: Joint, given_deg: list[float]) -> Iterator[tuple[Pose, float, float]]:
    low, high = min(given_deg), max(given_deg)
    axis = bench.arm.axes[NUMBERS[joint]]
    if low - bench.take_up_deg < axis.low or high + bench.take_up_deg > axis.high:
        raise PlanError(
            f"{joint} goes from {axis.low:g}° to {axis.high:g}°, and the arc from {low:g}° to {high:g}° needs "
            f"{bench.take_up_deg:g}° more at either end: make the arc smaller"
        )
    yield from ((standing, low, high) for standing in _standing(bench, joint))


def _standing(bench: ScaraBench, joint: Joint) -> Iterator[Pose]:
    """Yield how the other joints may stand."""
    other = 1 - NUMBERS[joint]
    nodes = (bench.nodes1_deg, bench.nodes2_deg)[other]
    low, high = bench.j4_limits_deg
    yield from (with_axis((0.0, 0.0, bench.j3_mm, min(max(0.0, low), high)), other, node) for node in nodes)


def _reach(bench: ScaraBench, joint: Joint, standing: Pose) -> float:
    """Return how far out the arm reaches while J1 turns; while J2 does, how far J1 stands from its middle."""
    if joint == "J1":
        return -abs(standing[1])
    return abs(standing[0] - 0.5 * (bench.nodes1_deg[0] + bench.nodes1_deg[-1]))


def _clear_arcs(bench: ScaraBench, joint: Joint) -> Iterator[tuple[Pose, float, float]]:
    """Yield the longest clear arc for each way in which the other joint may stand."""
    axis, number = bench.arm.axes[NUMBERS[joint]], NUMBERS[joint]
    values = np.linspace(axis.low, axis.high, int((axis.high - axis.low) // _LOOK_DEG) + 1)
    for standing in _standing(bench, joint):
        poses = np.tile(np.array(standing), (values.size, 1))
        poses[:, number] = values
        blocked = np.flatnonzero(~clear_poses(poses, bench))
        edges = np.concatenate([[-1], blocked, [values.size]])
        longest = int(np.argmax(np.diff(edges)))
        first, last = int(edges[longest]) + 1, int(edges[longest + 1]) - 1
        if last > first:
            yield standing, values[first] + bench.take_up_deg, values[last] - bench.take_up_deg
