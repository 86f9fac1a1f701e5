"""The paper's layout, with distances made from geometry written down here, not by the program.

Loops and plain trigonometry on purpose: it shares no code with what it tests.
"""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.points import Commands, Points

NODES1_DEG = [-140.0 + 20.0 * i for i in range(11)]
NODES2_DEG = [20.0 * i for i in range(8)]
NOMINAL_REFLECTORS = np.array([[650.0, -400.0], [680.0, 0.0], [640.0, 380.0]])
NAMES = ("P1", "P2", "P3")
MDEG = math.radians(1e-3)


@dataclass(frozen=True)
class Truth:
    """An arm: links in mm, tables in rad by node index for + and −, reflectors in mm."""

    link1_mm: float
    link2_mm: float
    map1: dict[int, list[float]]
    map2: dict[int, list[float]]
    reflectors: Floats

    def table_vector(self) -> Floats:
        """Return links and tables in the order of the parameter vector."""
        return np.array(
            [self.link1_mm, self.link2_mm, *self.map1[1], *self.map1[-1], *self.map2[1], *self.map2[-1]]
        )


def random_truth(seed: int) -> Truth:
    """Draw an arm in the gauge of the program: the mean of the J1 map is zero."""
    rng = np.random.default_rng(seed)
    first = rng.normal(0.0, 12.0 * MDEG, (2, 11))
    first -= first.mean()
    second = rng.normal(-5.0 * MDEG, 12.0 * MDEG, (2, 8))
    return Truth(
        325.0 + float(rng.normal(0, 0.03)),
        225.0 + float(rng.normal(0, 0.03)),
        {1: first[0].tolist(), -1: first[1].tolist()},
        {1: second[0].tolist(), -1: second[1].tolist()},
        NOMINAL_REFLECTORS + rng.normal(0.0, 3.0, (3, 2)),
    )


def sequence() -> list[tuple[int, int, int, int]]:
    """Return node indices and directions of the 352 commands (Eqs 11 and 12)."""
    first = [(i, 1) for i in range(11)] + [(i, -1) for i in reversed(range(11))]
    second = [(i, 1) for i in range(8)] + [(i, -1) for i in reversed(range(8))]
    return [(i1, i2, s1, s2) for i1, s1 in first for i2, s2 in second]


def true_position(truth: Truth, command: tuple[int, int, int, int]) -> tuple[float, float]:
    """Return where the J4 axis stands at a command."""
    i1, i2, s1, s2 = command
    a = math.radians(NODES1_DEG[i1]) + truth.map1[s1][i1]
    b = a + math.radians(NODES2_DEG[i2]) + truth.map2[s2][i2]
    return (
        truth.link1_mm * math.cos(a) + truth.link2_mm * math.cos(b),
        truth.link1_mm * math.sin(a) + truth.link2_mm * math.sin(b),
    )


def paper_points(
    truth: Truth, reflectors: int = 3, noise_mm: Floats | None = None, sigma_mm: float | None = None
) -> Points:
    """Return the paper's measurement of an arm, one dead path a reflector, zero at the first point."""
    rows = sequence()
    displacement, reflector = [], []
    for j in range(reflectors):
        lengths = [math.dist(true_position(truth, row), truth.reflectors[j]) for row in rows]
        displacement += [length - lengths[0] for length in lengths]
        reflector += [j] * len(rows)
    columns: Ints = np.array(rows * reflectors)
    index: Ints = np.array(reflector)
    values = np.array(displacement) + (0.0 if noise_mm is None else noise_mm)
    commands = Commands(
        np.deg2rad(np.array(NODES1_DEG)[columns[:, 0]]),
        np.deg2rad(np.array(NODES2_DEG)[columns[:, 1]]),
        columns[:, 2],
        columns[:, 3],
    )
    sigma = None if sigma_mm is None else np.full(values.size, sigma_mm)
    names = NAMES[:reflectors]
    return Points(commands, index, index.copy(), values, sigma, names, tuple((name, 0) for name in names))
