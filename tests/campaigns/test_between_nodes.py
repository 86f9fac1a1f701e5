"""Ripples between the nodes of an arm that is written down here: what identified arms predict on a path.

Distances come from the paper's arm with radial error motions and scatter as stated; the ripple of each joint and
direction has an order of 36 to 100 of its own. Path points are where that arm really stands.

`CATSEYE_RIPPLE_SETS` sets how many arms [60].
"""

import cmath
import math
import os
from dataclasses import dataclass

import numpy as np
import pytest

from catseye.app.cell.scara.uncertainty import Uncertainty
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.extension import Term, periodic
from catseye.calibration.scara.identification import identify
from catseye.calibration.scara.points import Commands, Points
from catseye.calibration.scara.prediction import predict
from catseye.procedures.scara.motion.approach import Command
from catseye.procedures.scara.open_loop.off_node import measuring_sequence, usual_count
from catseye.procedures.scara.path.path_plan import path_points
from tests.unit.calibration.scara.paper import (
    NAMES,
    NODES1_DEG,
    NODES2_DEG,
    NOMINAL_REFLECTORS,
    Truth,
    random_truth,
)
from tests.unit.procedures.benches import bench

SETS = int(os.environ.get("CATSEYE_RIPPLE_SETS", "60"))
SCATTER_MM = 0.010
RADIAL_MM = (0.005, 0.005, 0.010)
ORDERS = 5
SEQUENCE = measuring_sequence(tuple(NODES1_DEG), tuple(NODES2_DEG), usual_count(tuple(NODES1_DEG)))


@dataclass(frozen=True)
class Ripple:
    """What a joint does beside its map, rad; each direction has an order and a phase of its own."""

    size_rad: float
    waves: dict[int, tuple[int, float]]

    @classmethod
    def drawn(cls, rng: np.random.Generator, size_mdeg: float) -> "Ripple":
        waves = {s: (int(rng.integers(36, 101)), float(rng.uniform(0.0, 2.0 * math.pi))) for s in (1, -1)}
        return cls(math.radians(1e-3 * size_mdeg), waves)

    @classmethod
    def of_gear(cls, rng: np.random.Generator, size_mdeg: float, order: int) -> "Ripple":
        phase = float(rng.uniform(0.0, 2.0 * math.pi))
        return cls(math.radians(1e-3 * size_mdeg), {1: (order, phase), -1: (order, phase)})

    def at(self, theta_deg: float, direction: int) -> float:
        order, phase = self.waves[direction]
        return self.size_rad * math.sin(order * math.radians(theta_deg) + phase)


class Arm:
    """A true arm: links and maps of the paper's layout, ripples, radial error motions."""

    def __init__(self, seed: int, size_mdeg: float, gears: tuple[int, ...] = ()) -> None:
        self.rng = np.random.default_rng([seed, 16])
        self.truth: Truth = random_truth(seed)
        self.ripples = [Ripple.of_gear(self.rng, size_mdeg, order) for order in gears] or [
            Ripple.drawn(self.rng, size_mdeg) for _ in range(2)
        ]
        self.motions = [self.rng.normal(0.0, u / math.sqrt(ORDERS), (2, ORDERS, 2)) for u in RADIAL_MM]

    def _joint(self, joint: int, theta_deg: float, direction: int) -> float:
        nodes = (NODES1_DEG, NODES2_DEG)[joint]
        table = (self.truth.map1, self.truth.map2)[joint][direction]
        deviation = float(np.interp(theta_deg, nodes, table)) + self.ripples[joint].at(theta_deg, direction)
        return math.radians(theta_deg) + deviation

    def _motion(self, axis: int, angle_rad: float) -> complex:
        x, y = (
            sum(c * math.cos(k * angle_rad) + s * math.sin(k * angle_rad) for k, (c, s) in enumerate(rows, 1))
            for rows in self.motions[axis]
        )
        return complex(x, y)

    def stands(self, one: float, two: float, s1: int, s2: int, beam_to: complex | None) -> complex:
        """Return where the J4 axis comes to rest; the tool aims at a place, or does not turn against link 2."""
        a = self._joint(0, one, s1)
        b = a + self._joint(1, two, s2)
        axis = cmath.rect(self.truth.link1_mm, a) + cmath.rect(self.truth.link2_mm, b)
        first, both = math.radians(one), math.radians(one + two)
        tool = 0.0 if beam_to is None else cmath.phase(beam_to - axis) - both
        axis += self._motion(0, first) + cmath.rect(1.0, first) * self._motion(1, math.radians(two))
        axis += cmath.rect(1.0, both) * self._motion(2, tool)
        return axis + complex(*self.rng.normal(0.0, SCATTER_MM, 2))

    def distances(self) -> Points:
        rows = SEQUENCE * len(NAMES)
        lengths, index = [], []
        for number, place in enumerate(complex(*xy) for xy in self.truth.reflectors.tolist()):
            for c in SEQUENCE:
                at = self.stands(c.theta1_deg, c.theta2_deg, c.direction1, c.direction2, place)
                lengths.append(abs(at - place))
                index.append(number)
        reflector = np.array(index, dtype=np.int64)
        dead_paths = tuple((name, 0) for name in NAMES)
        return Points(
            commands_of(rows), reflector, reflector.copy(), np.array(lengths), None, NAMES, dead_paths
        )


def commands_of(rows: tuple[Command, ...]) -> Commands:
    theta = np.deg2rad([(row.theta1_deg, row.theta2_deg) for row in rows])
    states = np.array([(row.direction1, row.direction2) for row in rows], dtype=np.int64)
    return Commands(theta[:, 0], theta[:, 1], states[:, 0], states[:, 1])


def path() -> tuple[Command, ...]:
    """Return the commands of the paper's path that lie inside the nodes."""
    points = path_points(bench(), 200.0, (-500.0, 500.0), 10.0, "right")
    commands = (
        Command(i, p.theta1_deg, p.theta2_deg, p.direction1, p.direction2) for i, p in enumerate(points)
    )
    return tuple(c for c in commands if -140.0 <= c.theta1_deg <= 60.0 and 0.0 <= c.theta2_deg <= 140.0)


def predicted_errors(arm: Arm, terms: tuple[Term, ...] = ()) -> tuple[Floats, Floats]:
    """Return the errors of predicted coordinates, in the frame of the gauge, and what is stated for them, mm."""
    way, budget = path(), Uncertainty().budget
    nodes = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)
    found = identify(arm.distances(), "error-map", *nodes, 325.0, 225.0, NOMINAL_REFLECTORS, budget, terms)
    predicted = predict(found.arm, commands_of(way), 325.0, 225.0)
    stood = np.array([arm.stands(c.theta1_deg, c.theta2_deg, c.direction1, c.direction2, None) for c in way])
    # The program's map has the mean 0 at its nodes; the true one has the ripples' mean there besides.
    turn = np.mean([arm.ripples[0].at(node, s) for node in NODES1_DEG for s in (1, -1)])
    stood = stood * cmath.exp(-1j * float(turn))
    return predicted.position_mm - np.column_stack([stood.real, stood.imag]), predicted.u_mm


def normalised(seed: int, size_mdeg: float) -> Floats:
    errors_mm, u_mm = predicted_errors(Arm(seed, size_mdeg))
    return np.asarray(errors_mm / u_mm, dtype=np.float64)


@pytest.mark.timeout(60 + 20 * SETS)
@pytest.mark.parametrize("size_mdeg", [0.0, 3.0])
def test_path_points_lie_within_what_is_stated(size_mdeg: float) -> None:
    errors = np.concatenate([normalised(seed, size_mdeg).ravel() for seed in range(SETS)])
    rms, within = float(np.sqrt(np.mean(errors**2))), float(np.mean(np.abs(errors) <= 2.0))
    print(f"\nripple {size_mdeg:g} mdeg, {SETS} arms: z rms {rms:.2f}, {100.0 * within:.1f} % within ±2 u")  # noqa: T201  # the figure
    assert 0.8 < rms < 1.2
    assert within >= 0.93


@pytest.mark.timeout(60 + 20 * SETS)
def test_known_gears_are_identified_with_the_map() -> None:
    gears = (100, 80)
    terms = (*periodic(1, gears[:1]), *periodic(2, gears[1:]))
    errors, stated, without = [], [], []
    for seed in range(SETS):
        off_mm, u_mm = predicted_errors(Arm(seed, 3.0, gears), terms)
        errors.append(off_mm / u_mm)
        stated.append(u_mm)
        without.append(predicted_errors(Arm(seed, 3.0, gears))[1])
    rms = float(np.sqrt(np.mean(np.square(errors))))
    ratio = float(np.sqrt(np.mean(np.square(stated)) / np.mean(np.square(without))))
    print(f"\ngears known, {SETS} arms: z rms {rms:.2f}, u {ratio:.2f} of that without them")  # noqa: T201  # the figure
    assert 0.8 < rms < 1.2
    assert ratio < 0.95
