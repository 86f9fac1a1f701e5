"""Which rows measure the same again, and what is left of rows once that has levels of its own."""

from dataclasses import dataclass

import numpy as np
from scipy import sparse

from catseye.calibration.core.types import Floats, Ints

_RANK_SQUARED = 1e-12
"""Squared singular values of a group's rows below this share of the largest count as zero."""


@dataclass(frozen=True)
class Repeats:
    """Rows in groups that measure the same: a number, or a vector that each row sees along a direction of its own.

    Attributes:
        group: number of what each row measures, shape (n,).
        along: direction in which each row sees the k levels of its group, of unit length, shape (n, k).
    """

    group: Ints
    along: Floats

    @classmethod
    def of_numbers(cls, group: Ints) -> "Repeats":
        """Return groups, given by the number of each row's, whose rows all measure the same number."""
        return cls(group, np.ones((group.size, 1)))

    def within(self, columns: Floats, weights: Floats) -> tuple[Floats, int]:
        """Return what the levels of the groups leave of weighted columns.

        Args:
            columns: weighted, shape (n, m).
            weights: of the rows, shape (n,).

        Returns:
            Sums of products, less what the levels would take, shape (m, m); the number of levels that rows settle.
        """
        levels = self.along.shape[1]
        groups = int(self.group.max()) + 1
        seen = self.along * weights[:, None]
        design = sparse.csr_array(
            (
                seen.ravel(),
                (levels * self.group[:, None] + np.arange(levels)).ravel(),
                levels * np.arange(self.group.size + 1),
            ),
            shape=(self.group.size, levels * groups),
        )
        members = sparse.csr_array((np.ones(self.group.size), self.group, np.arange(self.group.size + 1))).T
        products = np.reshape(seen[:, :, None] * seen[:, None, :], (-1, levels**2))
        squares = np.asarray(members @ products, dtype=np.float64)
        values, vectors = np.linalg.eigh(np.reshape(squares, (groups, levels, levels)))
        settled = values > _RANK_SQUARED * values[:, -1:]
        roots = vectors * np.where(settled, 1.0 / np.sqrt(np.where(settled, values, 1.0)), 0.0)[:, None, :]
        sums = np.reshape(np.asarray(design.T @ columns, dtype=np.float64), (groups, levels, -1))
        taken = np.reshape(roots.transpose(0, 2, 1) @ sums, (groups * levels, -1))
        return np.asarray(columns.T @ columns - taken.T @ taken), int(settled.sum())
