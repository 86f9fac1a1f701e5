"""Distances of an arm with more than error maps, made from geometry written down here, not by the program.

Loops and plain trigonometry on purpose. Commands lie on the nodes or between them.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.extension import Term
from catseye.calibration.scara.layout import ModelName
from catseye.calibration.scara.points import Commands, Points
from tests.unit.calibration.scara.paper import NAMES, NODES1_DEG, NODES2_DEG, NOMINAL_REFLECTORS, Truth

NODES1, NODES2 = np.deg2rad(NODES1_DEG), np.deg2rad(NODES2_DEG)


@dataclass(frozen=True)
class Pose:
    """One command as an extra error may depend on it: angles in rad, share of the run from -1/2 to 1/2."""

    theta1: float
    theta2: float
    beam: float
    share: float


@dataclass(frozen=True)
class Extra:
    """Errors beyond the maps: rad for the joints, mm for links and distance."""

    theta1: Callable[[Pose], float] = lambda _: 0.0
    theta2: Callable[[Pose], float] = lambda _: 0.0
    link1: Callable[[Pose], float] = lambda _: 0.0
    link2: Callable[[Pose], float] = lambda _: 0.0
    length: Callable[[Pose], float] = lambda _: 0.0


def commands_between(step1_deg: float = 9.1, step2_deg: float = 11.3) -> list[tuple[float, float, int, int]]:
    """Return commands in degrees that do not stand on the nodes, from all directions."""
    first = np.arange(-140.0, 60.0, step1_deg).tolist()
    second = np.arange(0.0, 140.0, step2_deg).tolist()
    ways1 = [(a, 1) for a in first] + [(a + 0.4 * step1_deg, -1) for a in reversed(first[:-1])]
    ways2 = [(b, 1) for b in second] + [(b + 0.6 * step2_deg, -1) for b in reversed(second[:-1])]
    return [(a, b, s1, s2) for a, s1 in ways1 for b, s2 in ways2]


def commands_on_nodes() -> list[tuple[float, float, int, int]]:
    """Return the paper's 352 commands in degrees."""
    ways1 = [(a, 1) for a in NODES1_DEG] + [(a, -1) for a in reversed(NODES1_DEG)]
    ways2 = [(b, 1) for b in NODES2_DEG] + [(b, -1) for b in reversed(NODES2_DEG)]
    return [(a, b, s1, s2) for a, s1 in ways1 for b, s2 in ways2]


def between(nodes_deg: list[float], table: list[float], angle_deg: float) -> float:
    """Return a table's value at an angle, straight lines between the nodes."""
    i = min(int((angle_deg - nodes_deg[0]) // 20.0), len(nodes_deg) - 2)
    share = (angle_deg - nodes_deg[i]) / 20.0
    return (1.0 - share) * table[i] + share * table[i + 1]


def measured(
    truth: Truth,
    commands: list[tuple[float, float, int, int]],
    extra: Extra | None = None,
    noise_mm: float = 0.0,
    sigma_mm: float | None = None,
    seed: int = 1,
) -> Points:
    """Return the distances to three reflectors, one segment each, zero at the first."""
    more = extra or Extra()
    total = 3 * len(commands)
    lengths = []
    for j in range(3):
        nominal, place = NOMINAL_REFLECTORS[j].tolist(), truth.reflectors[j].tolist()
        for k, (a_deg, b_deg, s1, s2) in enumerate(commands):
            a, b = math.radians(a_deg), math.radians(b_deg)
            share = (j * len(commands) + k) / (total - 1) - 0.5
            x, y = (
                325.0 * math.cos(a) + 225.0 * math.cos(a + b),
                325.0 * math.sin(a) + 225.0 * math.sin(a + b),
            )
            beam = math.atan2(nominal[1] - y, nominal[0] - x) - a - b
            pose = Pose(a, b, beam, share)
            one = a + between(NODES1_DEG, truth.map1[s1], a_deg) + more.theta1(pose)
            two = one + b + between(NODES2_DEG, truth.map2[s2], b_deg) + more.theta2(pose)
            l1, l2 = truth.link1_mm + more.link1(pose), truth.link2_mm + more.link2(pose)
            at = (l1 * math.cos(one) + l2 * math.cos(two), l1 * math.sin(one) + l2 * math.sin(two))
            lengths.append(math.dist(at, place) + more.length(pose))
    reflector = np.repeat(np.arange(3), len(commands))
    columns = np.array(commands * 3)
    zero = np.array(lengths)[reflector * len(commands)]
    exact = Points(
        Commands(
            np.deg2rad(columns[:, 0]),
            np.deg2rad(columns[:, 1]),
            columns[:, 2].astype(np.int64),
            columns[:, 3].astype(np.int64),
        ),
        reflector,
        reflector.copy(),
        np.array(lengths) - zero,
        None if sigma_mm is None else np.full(total, sigma_mm),
        NAMES,
        tuple((name, 0) for name in NAMES),
    )
    return with_noise(exact, noise_mm, seed)


def with_noise(points: Points, noise_mm: float, seed: int) -> Points:
    """Return distances with white errors."""
    noise = np.random.default_rng(seed).normal(0.0, 1.0, len(points)) * noise_mm
    return replace(points, displacement_mm=points.displacement_mm + noise)


def problem(points: Points, model: ModelName = "error-map", terms: tuple[Term, ...] = ()) -> Problem:
    """Return the problem of identifying the paper's arm."""
    return Problem(points, model, NODES1, NODES2, 325.0, 225.0, NOMINAL_REFLECTORS, None, terms)


def split(points: Points, row: int) -> Points:
    """Give the second half of the first reflector's distances a dead path of their own, from a row on."""
    second = (points.reflector == 0) & (np.arange(len(points)) >= row)
    return replace(
        points,
        dead_path=np.where(second, 3, points.dead_path),
        dead_paths=(*points.dead_paths, (points.reflector_names[0], 1)),
    )


def coefficients(values: Floats, names: list[str]) -> dict[str, float]:
    """Return values by name."""
    return dict(zip(names, values.tolist(), strict=True))
