"""Distances and their derivatives by loops, trigonometry and difference quotients: shares no code with the program.

The uncertainties come from the pseudo-inverse of the whole dense problem, reflectors and dead paths included, moved
into the gauge of the program (mean of the J1 map = 0) along the known null direction, a rotation of everything
about J1.
"""

import math
from dataclasses import dataclass

import numpy as np
from scipy import linalg

from catseye.calibration.core.types import Floats

Row = tuple[int, int, int, int]
"""Node indices of J1 and J2, directions of approach."""

LINKS = (325.0, 225.0)


@dataclass(frozen=True)
class DenseArm:
    """An arm with commands at its nodes: nodes in deg, rows in measuring order."""

    nodes1_deg: tuple[float, ...]
    nodes2_deg: tuple[float, ...]

    def rows(self) -> list[Row]:
        """Return every pair of nodes from all four directions."""
        first = [(i, s) for s in (1, -1) for i in range(len(self.nodes1_deg))]
        second = [(i, s) for s in (1, -1) for i in range(len(self.nodes2_deg))]
        return [(i1, i2, s1, s2) for i1, s1 in first for i2, s2 in second]

    @property
    def arm_size(self) -> int:
        """Links and both maps."""
        return 2 + 2 * len(self.nodes1_deg) + 2 * len(self.nodes2_deg)

    def distance(self, arm: Floats, row: Row, place: Floats) -> float:
        """Return the distance of a place from the J4 axis."""
        i1, i2, s1, s2 = row
        m1, m2 = len(self.nodes1_deg), len(self.nodes2_deg)
        a = math.radians(self.nodes1_deg[i1]) + arm[2 + i1 + (0 if s1 > 0 else m1)]
        b = a + math.radians(self.nodes2_deg[i2]) + arm[2 + 2 * m1 + i2 + (0 if s2 > 0 else m2)]
        x = arm[0] * math.cos(a) + arm[1] * math.cos(b)
        y = arm[0] * math.sin(a) + arm[1] * math.sin(b)
        return math.dist((x, y), place)

    def block(self, place: Floats, rows: list[Row] | None = None) -> Floats:
        """Return the derivatives by arm, place and dead path, shape (n, arm + 3)."""
        start = np.concatenate([LINKS, np.zeros(self.arm_size - 2), place])
        used = self.rows() if rows is None else rows

        def distances(p: Floats) -> Floats:
            return np.array([self.distance(p[:-2], row, p[-2:]) for row in used])

        columns = []
        for i in range(start.size):
            step = np.zeros(start.size)
            step[i] = 1e-5 if 2 <= i < self.arm_size else 1e-2
            columns.append((distances(start + step) - distances(start - step)) / (2.0 * step[i]))
        return np.column_stack([*columns, -np.ones(len(used))])

    def jacobian(self, blocks: list[Floats]) -> Floats:
        """Join the blocks of reflectors: common arm, own place and dead path each."""
        arm = self.arm_size
        whole = np.zeros((sum(len(block) for block in blocks), arm + 3 * len(blocks)))
        first = 0
        for k, block in enumerate(blocks):
            rows = slice(first, first + len(block))
            whole[rows, :arm] = block[:, :arm]
            whole[rows, arm + 3 * k : arm + 3 * k + 3] = block[:, arm:]
            first += len(block)
        return whole

    def covariance(
        self, blocks: list[Floats], places: Floats, sigma_mm: float, effects_mm: Floats | None = None
    ) -> Floats:
        """Return the covariance of the arm's parameters in the gauge of the program.

        Args:
            effects_mm: what shared sources do to the distances, mm, shape (n, m).
        """
        jacobian = self.jacobian(blocks)
        if effects_mm is not None:
            effects = effects_mm / sigma_mm
            inverse_root = linalg.inv(linalg.sqrtm(np.eye(len(effects)) + effects @ effects.T)).real
            jacobian = inverse_root @ jacobian
        size, arm = jacobian.shape[1], self.arm_size
        norms = np.linalg.norm(jacobian, axis=0)
        inverse = np.linalg.pinv(jacobian / norms, rcond=1e-9) / norms[:, None]
        null, constraint = np.zeros(size), np.zeros(size)
        table = slice(2, 2 + 2 * len(self.nodes1_deg))
        null[table], constraint[table] = 1.0, 1.0
        for k, (x, y) in enumerate(places):
            null[arm + 3 * k : arm + 3 * k + 2] = -y, x
        moved = inverse - np.outer(null, constraint @ inverse) / (constraint @ null)
        return np.asarray(sigma_mm**2 * (moved @ moved.T)[:arm, :arm], dtype=np.float64)
