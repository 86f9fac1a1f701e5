"""A continuous scan, with distances made from geometry written down here, not by the program.

Both joints run to and fro at speeds of their own; the beam stays on one reflector a segment.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.points import Commands, Points

RANGE1_DEG = (-140.0, 60.0)
RANGE2_DEG = (0.0, 140.0)
NOMINAL_REFLECTORS = np.array([[650.0, -400.0], [680.0, 0.0], [640.0, 380.0]])
NAMES = ("P1", "P2", "P3")
MDEG = float(np.deg2rad(1e-3))


@dataclass(frozen=True)
class Arm:
    """A true arm: links in mm, nodes and tables in rad (row 0 for +, row 1 for −), reflectors in mm."""

    link1_mm: float
    link2_mm: float
    nodes1_rad: Floats
    nodes2_rad: Floats
    table1_rad: Floats
    table2_rad: Floats
    reflectors_mm: Floats

    def parameters(self) -> Floats:
        """Return links and tables in the order of the parameter vector."""
        return np.array([self.link1_mm, self.link2_mm, *self.table1_rad.ravel(), *self.table2_rad.ravel()])


def arm(seed: int, step_deg: float) -> Arm:
    """Draw an arm with nodes every so many degrees; the mean of its J1 map is zero."""
    rng = np.random.default_rng(seed)
    nodes1 = np.deg2rad(np.linspace(*RANGE1_DEG, round(200.0 / step_deg) + 1))
    nodes2 = np.deg2rad(np.linspace(*RANGE2_DEG, round(140.0 / step_deg) + 1))
    first = rng.normal(0.0, 12.0 * MDEG, (2, nodes1.size))
    return Arm(
        325.0 + float(rng.normal(0.0, 0.03)),
        225.0 + float(rng.normal(0.0, 0.03)),
        nodes1,
        nodes2,
        first - first.mean(),
        rng.normal(-5.0 * MDEG, 12.0 * MDEG, (2, nodes2.size)),
        NOMINAL_REFLECTORS + rng.normal(0.0, 3.0, (3, 2)),
    )


def to_and_fro(phase: Floats, low_deg: float, high_deg: float) -> tuple[Floats, Ints]:
    """Return angles, rad, of a joint that runs to and fro once a unit of phase, and its directions."""
    share = 2.0 * np.mod(phase, 1.0)
    upwards = share < 1.0
    angle = low_deg + (high_deg - low_deg) * np.where(upwards, share, 2.0 - share)
    return np.deg2rad(angle), np.where(upwards, 1, -1).astype(np.int64)


def true_lengths(truth: Arm, commands: Commands, reflector: Ints) -> Floats:
    """Return the distances from reflector to J4 axis, mm."""

    def deviation(nodes: Floats, table: Floats, angle: Floats, direction: Ints) -> Floats:
        up, down = np.interp(angle, nodes, table[0]), np.interp(angle, nodes, table[1])
        return np.asarray(np.where(direction > 0, up, down), dtype=np.float64)

    a = commands.theta1_rad + deviation(
        truth.nodes1_rad, truth.table1_rad, commands.theta1_rad, commands.direction1
    )
    b = (
        a
        + commands.theta2_rad
        + deviation(truth.nodes2_rad, truth.table2_rad, commands.theta2_rad, commands.direction2)
    )
    x = truth.link1_mm * np.cos(a) + truth.link2_mm * np.cos(b) - truth.reflectors_mm[reflector, 0]
    y = truth.link1_mm * np.sin(a) + truth.link2_mm * np.sin(b) - truth.reflectors_mm[reflector, 1]
    return np.asarray(np.sqrt(x * x + y * y), dtype=np.float64)


def scan(
    truth: Arm,
    rows: int,
    segments: int = 2,
    noise_mm: Floats | float = 0.0,
    sigma_mm: Floats | float | None = None,
    seed: int = 0,
) -> Points:
    """Return a scan: to each reflector in turn so many segments, zero at the first row of each."""
    index = np.arange(rows)
    stretch = index * 3 * segments // rows
    reflector = stretch // segments
    # J1 runs 31 times to and fro in all, J2 a little more than 5 times as often: together they cover the plane.
    phase = index / rows * 31.0
    theta1, direction1 = to_and_fro(phase, *RANGE1_DEG)
    theta2, direction2 = to_and_fro(phase * 5.0 * 1.1180339887, *RANGE2_DEG)
    commands = Commands(theta1, theta2, direction1, direction2)
    lengths = true_lengths(truth, commands, reflector)
    zero = lengths[np.searchsorted(stretch, np.arange(3 * segments))]
    noise = np.random.default_rng(seed).normal(0.0, 1.0, rows) * noise_mm
    displacement = lengths - zero[stretch] + noise
    sigma = None if sigma_mm is None else np.broadcast_to(np.asarray(sigma_mm, dtype=np.float64), rows).copy()
    paths = tuple((NAMES[i // segments], i % segments) for i in range(3 * segments))
    return Points(commands, reflector, stretch, displacement, sigma, NAMES, paths)
