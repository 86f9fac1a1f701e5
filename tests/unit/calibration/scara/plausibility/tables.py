"""Measured tables with the cell they are read with: sound ones, and ones that somebody has spoiled.

Plain trigonometry and noise of its own: it shares no code with what it tests.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.budget import Axis, Budget, Contributor
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.layout import ModelName
from catseye.calibration.scara.points import Commands, Points
from tests.unit.calibration.scara.paper import (
    NAMES,
    NODES1_DEG,
    NODES2_DEG,
    NOMINAL_REFLECTORS,
    sequence,
)

NDComplex = NDArray[np.complex128]


@dataclass(frozen=True)
class Table:
    """What a points file and a cell file say.

    Attributes:
        theta_deg: commands of J1 and J2, shape (n, 2).
        direction: states of approach, shape (n, 2).
        reflector: index of each row, shape (n,).
        segment: number of each row, shape (n,).
        displacement: as the column displacement_mm has it, shape (n,).
        rough_mm: rough places, shape (reflectors, 2).
        links_mm: nominal links.
        nodes_deg: nodes of both maps.
    """

    theta_deg: Floats
    direction: Ints
    reflector: Ints
    segment: Ints
    displacement: Floats
    rough_mm: Floats
    links_mm: tuple[float, float] = (325.0, 225.0)
    nodes_deg: tuple[tuple[float, ...], tuple[float, ...]] = (tuple(NODES1_DEG), tuple(NODES2_DEG))

    def problem(self, budget: Budget | None, model: ModelName = "error-map") -> Problem:
        """Return the table as it is given to an identification."""
        names = NAMES[: len(self.rough_mm)]
        keys = list(zip(self.reflector.tolist(), self.segment.tolist(), strict=True))
        number = {key: i for i, key in enumerate(dict.fromkeys(keys))}
        one, two = np.radians(self.theta_deg).T
        points = Points(
            Commands(one, two, self.direction[:, 0], self.direction[:, 1]),
            self.reflector,
            np.array([number[key] for key in keys]),
            self.displacement,
            None if budget is not None else np.full(len(keys), 0.02),
            names,
            tuple((names[name], segment) for name, segment in number),
        )
        nodes1, nodes2 = (np.radians(nodes) for nodes in self.nodes_deg)
        return Problem(points, model, nodes1, nodes2, *self.links_mm, self.rough_mm, budget)


def table_2() -> Budget:
    """Return the paper's budget: what repeats with the angles, and 10 µm that differ from reading to reading."""
    radial: tuple[tuple[Axis, float], ...] = (("j1", 0.005), ("j2", 0.005), ("j4", 0.010))
    shared = (Contributor(axis, "radial", u, "axis-angle", axis) for axis, u in radial)
    return Budget((Contributor("repeatability", "length", 0.010), *shared))


LOST_AT = 352 + 171
"""Row at which the count of P2 begins anew where its zero is lost."""

_BREAKS = np.setdiff1d(np.arange(20, 332), np.arange(LOST_AT - 352 - 5, LOST_AT - 352 + 6))
"""Where the beam may break in a series: what is left of a segment after a lost zero has to carry a dead path."""


@dataclass(frozen=True)
class Faults:
    """What is wrong with a bench that is sound.

    Attributes:
        radial: radial error motions as multiples of the stated 5, 5 and 10 µm.
        drift_mm: standard deviation of an AR(1) drift with a time constant of 200 distances.
        ripple_deg: amplitude of a gear ripple of J1 and of J2.
        rough_mm: standard deviation of the rough places.
        reflectors: how many.
        breaks: how often the beam is lost at each reflector.
        links_mm: true links.
        map_deg: standard deviation of the map at a node.
        off_nodes: commands are drawn between the nodes.
    """

    radial: float = 1.0
    drift_mm: float = 0.0
    ripple_deg: float = 0.0
    rough_mm: float = 1.0
    reflectors: int = 3
    breaks: int = 0
    links_mm: tuple[float, float] = (325.0, 225.0)
    map_deg: float = 0.012
    off_nodes: bool = False


SOUND = Faults()


def measured(seed: int, faults: Faults = SOUND) -> Table:
    """Return the table of a sound measurement."""
    rng = np.random.default_rng([20_26, seed])
    rows = np.array(sequence())
    theta = np.column_stack([np.array(NODES1_DEG)[rows[:, 0]], np.array(NODES2_DEG)[rows[:, 1]]])
    if faults.off_nodes:
        low, high = theta.min(axis=0), theta.max(axis=0)
        theta = np.clip(theta + rng.uniform(-9.0, 9.0, theta.shape), low, high)
    direction = rows[:, 2:]
    actual = np.radians(theta + _deviation_deg(rng, theta, direction, faults))
    one, both = actual[:, 0], actual.sum(axis=1)
    links = np.array(faults.links_mm) + rng.normal(0.0, 0.05, 2)
    axis = links[0] * np.exp(1j * one) + links[1] * np.exp(1j * both)
    axis = axis + faults.radial * (
        0.005 * _wobble(rng, one) + 0.005 * np.exp(1j * one) * _wobble(rng, actual[:, 1])
    )
    tool = _waves(rng)
    places = NOMINAL_REFLECTORS[: faults.reflectors] + rng.normal(0.0, 3.0, (faults.reflectors, 2))
    displacement, segments = [], []
    for place in places:
        beam = complex(*place) - axis
        turn = np.angle(beam) - both
        length = np.abs(beam - faults.radial * 0.010 * np.exp(1j * both) * _at(tool, turn))
        begins = np.sort(rng.choice(_BREAKS, faults.breaks, replace=False))
        segment = np.searchsorted(begins, np.arange(len(rows)), side="right")
        first = np.concatenate([[0], begins])[segment]
        displacement.append(length - length[first])
        segments.append(segment)
    count = faults.reflectors * len(rows)
    noise = rng.normal(0.0, 0.010, count) + _drift(rng, count, faults.drift_mm)
    return Table(
        np.tile(theta, (faults.reflectors, 1)),
        np.tile(direction, (faults.reflectors, 1)),
        np.repeat(np.arange(faults.reflectors), len(rows)),
        np.concatenate(segments),
        np.concatenate(displacement) + noise,
        rough_mm=places + rng.normal(0.0, faults.rough_mm, places.shape),
    )


def _deviation_deg(rng: np.random.Generator, theta: Floats, direction: Ints, faults: Faults) -> Floats:
    """Return how far the joints are from their commands, shape (n, 2)."""
    columns = []
    for joint, nodes in ((0, NODES1_DEG), (1, NODES2_DEG)):
        up, down = rng.normal(0.0, faults.map_deg, (2, len(nodes)))
        at = theta[:, joint]
        values = np.where(direction[:, joint] > 0, np.interp(at, nodes, up), np.interp(at, nodes, down))
        order, phase = rng.integers(36, 101), rng.uniform(0.0, 2.0 * math.pi)
        columns.append(values + faults.ripple_deg * np.sin(order * np.radians(at) + phase))
    return np.column_stack(columns)


def _waves(rng: np.random.Generator) -> Floats:
    """Return random Fourier coefficients of orders 1 to 5 in x and y, of unit rms each, shape (2, 2, 5)."""
    waves = rng.normal(0.0, 1.0, (2, 2, 5))
    return np.asarray(waves / math.sqrt(5.0))


def _at(waves: Floats, angle: Floats) -> NDComplex:
    orders = np.arange(1, 6)[:, None] * angle
    x, y = (
        np.tensordot(cosine, np.cos(orders), 1) + np.tensordot(sine, np.sin(orders), 1)
        for cosine, sine in waves
    )
    return np.asarray(x + 1j * y)


def _wobble(rng: np.random.Generator, angle: Floats) -> NDComplex:
    return _at(_waves(rng), angle)


def _drift(rng: np.random.Generator, count: int, sigma_mm: float) -> Floats:
    keeps = math.exp(-1.0 / 200.0)
    steps = rng.normal(0.0, sigma_mm * math.sqrt(1.0 - keeps**2), count)
    drift = np.zeros(count)
    for i in range(1, count):
        drift[i] = keeps * drift[i - 1] + steps[i]
    return drift


def _scaled(table: Table, factor: float) -> Table:
    return replace(table, displacement=factor * table.displacement)


def _turned(table: Table, *factors: float) -> Table:
    # Who reverses an angle reverses the sides that it is approached from.
    return replace(
        table,
        theta_deg=table.theta_deg * factors,
        direction=(table.direction * np.sign(factors)).astype(np.int64),
    )


def _shifted(table: Table) -> Table:
    return replace(table, displacement=np.roll(table.displacement, 1))


def _exchanged(table: Table) -> Table:
    names = table.reflector
    return replace(table, reflector=np.where(names < 2, 1 - names, names))


def _zero_lost(table: Table) -> Table:
    displacement = table.displacement.copy()
    later = (table.reflector == 1) & (np.arange(len(displacement)) >= LOST_AT)
    displacement[later] -= displacement[LOST_AT]
    return replace(table, displacement=displacement)


MISTAKES: dict[str, Callable[[Table], Table]] = {
    "sign of θ1": lambda table: _turned(table, -1.0, 1.0),
    "sign of θ2": lambda table: _turned(table, 1.0, -1.0),
    "sign of both": lambda table: _turned(table, -1.0, -1.0),
    "sign of the displacement": lambda table: _scaled(table, -1.0),
    "radians for degrees": lambda table: _turned(table, math.pi / 180.0, math.pi / 180.0),
    "metres": lambda table: _scaled(table, 1e-3),
    "inches": lambda table: _scaled(table, 1.0 / 25.4),
    "counts": lambda table: _scaled(table, 1.0 / 0.000158247),
    "a scale 5 % off": lambda table: _scaled(table, 1.05),
    "L1 and L2 exchanged": lambda table: replace(table, links_mm=table.links_mm[::-1]),
    "links of another arm": lambda table: replace(table, links_mm=(400.0, 300.0)),
    "rows shifted by one": _shifted,
    "names exchanged": _exchanged,
    "places mirrored": lambda table: replace(table, rough_mm=table.rough_mm * [1.0, -1.0]),
    "a zero lost inside a segment": _zero_lost,
}
"""The classic mistakes; units and scales are one of them."""

SOUND_BENCHES = (
    SOUND,
    Faults(radial=3.0),
    Faults(drift_mm=0.02),
    Faults(ripple_deg=0.003),
    Faults(reflectors=1),
    Faults(reflectors=2, rough_mm=20.0),
    Faults(breaks=3),
    Faults(radial=3.0, drift_mm=0.02, ripple_deg=0.003, breaks=2),
    Faults(radial=3.0, drift_mm=0.02, ripple_deg=0.003, breaks=2, reflectors=1, rough_mm=3.0),
    Faults(radial=3.0, drift_mm=0.02, breaks=5, reflectors=2),
    Faults(map_deg=0.1, rough_mm=10.0),
    Faults(ripple_deg=0.003, off_nodes=True),
)
"""What a bench may have without anything being wrong with its measurement."""
