"""Sums of products of rows whose common level in each group is unknown, kept up row by row.

The level is eliminated by taking the rows from the mean of their group.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats, Ints


@dataclass
class CentredSums:
    """Sums of products of rows that are taken from the means of their groups.

    Attributes:
        matrix: sums of products, shape (columns + 1, columns + 1).
        counts: rows of each group.
        means: mean row of each group.
    """

    matrix: Floats
    counts: dict[tuple[int, int], int]
    means: dict[tuple[int, int], Floats]

    @classmethod
    def empty(cls, columns: int) -> "CentredSums":
        """Return the sums of nothing."""
        return cls(np.zeros((columns + 1, columns + 1)), {}, {})

    @classmethod
    def of(cls, stacked: Floats, keys: list[tuple[int, int]]) -> "CentredSums":
        """Return the sums of rows."""
        names = list(dict.fromkeys(keys))
        number = {key: i for i, key in enumerate(names)}
        group = np.array([number[key] for key in keys])
        counts = np.bincount(group)
        means = group_sums(stacked, group) / counts[:, None]
        from_mean = stacked - means[group]
        return cls(
            from_mean.T @ from_mean,
            {key: int(counts[i]) for key, i in number.items()},
            {key: means[i].copy() for key, i in number.items()},
        )

    def add(self, stacked: Floats, key: tuple[int, int]) -> None:
        """Add a row; the mean of its group moves, and so does everything taken from it (Welford)."""
        count = self.counts.get(key, 0)
        if count == 0:
            self.counts[key], self.means[key] = 1, stacked.copy()
            return
        from_mean = stacked - self.means[key]
        self.matrix += np.outer(from_mean * (count / (count + 1.0)), from_mean)
        self.means[key] += from_mean / (count + 1.0)
        self.counts[key] = count + 1


def group_sums(rows: Floats, group: Ints) -> Floats:
    """Return the sums of rows over groups, shape (groups, columns).

    Args:
        rows: shape (n, columns).
        group: number of each row's group, from 0, none left out, shape (n,).
    """
    order = np.argsort(group, kind="stable")
    starts = np.flatnonzero(np.diff(group[order], prepend=-1))
    return np.asarray(np.add.reduceat(rows[order], starts, axis=0), dtype=np.float64)
