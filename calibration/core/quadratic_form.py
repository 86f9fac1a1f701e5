"""A sum of squares of correlated normal errors: how probable is one this large?"""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats

_NEGLIGIBLE = 1e-12
"""Sources below this share of the largest one are rounding."""

_NEAR_MEAN = 1e-4
"""Within so many standard deviations of the mean the formula for it serves."""


@dataclass(frozen=True)
class SumOfSquares:
    """dᵀd of normal errors d with a covariance W: a sum of χ² variables in the sizes of W's eigenvalues.

    Attributes:
        sizes: different eigenvalues of W, shape (m,).
        counts: how often each occurs, the degrees of freedom of its χ², shape (m,).
    """

    sizes: Floats
    counts: Floats

    @classmethod
    def of(cls, effects: Floats, white: Floats, basis: Floats) -> "SumOfSquares":
        """Return that of W = P (E Eᵀ + D) P without building W; P = I − Q Qᵀ takes a fit off.

        Where D is not the same everywhere, the eigenvalues are those to first order in what it differs by.

        Args:
            effects: E of m shared sources, shape (n, m).
            white: diagonal of D, shape (n,).
            basis: orthonormal columns Q of what was fitted, shape (n, k).
        """
        left = effects - basis @ (basis.T @ effects)
        axes, shared = _principal(left)
        along = np.sum(axes**2 * white[:, None], axis=0)
        rest = float(white.sum() - np.sum(basis**2 * white[:, None]) - along.sum())
        count = white.size - basis.shape[1] - along.size
        sizes, counts = np.append(shared + along, rest / max(count, 1)), np.append(np.ones(along.size), count)
        present = (sizes > 0.0) & (counts > 0)
        return cls(sizes[present], counts[present])

    @property
    def mean(self) -> float:
        """What the sum is expected to be: trace W."""
        return self._cumulant(1)

    @property
    def dof(self) -> float:
        """Degrees of freedom of the χ² with the same ratio of mean and spread (Satterthwaite)."""
        return 2.0 * self.mean**2 / self._cumulant(2) if self.sizes.size else 0.0

    def _cumulant(self, order: int) -> float:
        factor = 2.0 ** (order - 1) * math.factorial(order - 1)
        return factor * float(self.counts @ self.sizes**order)

    def probability(self, square: float) -> float:
        """Return the probability of a sum this large, by the saddlepoint of its cumulants (Barndorff-Nielsen's form).

        Two moments would not do: a χ² of few degrees of freedom may nearly vanish, but white errors keep this sum
        from it. See D. Kuonen, Biometrika 86 (1999) 929.
        """
        if not self.sizes.size:
            return 0.0
        # Whoever only lists procedures imports this module too.
        from scipy import optimize, special

        spread = math.sqrt(self._cumulant(2))
        if abs(square - self.mean) < _NEAR_MEAN * spread:
            return 0.5 - self._cumulant(3) / (6.0 * math.sqrt(2.0 * math.pi) * spread**3)
        if square <= 0.0:
            return 1.0
        largest = int(np.argmax(self.sizes))
        # Half and twice as far as bounds of the slope reach: where all sizes are one, they are the point itself.
        lowest = -float(self.counts.sum()) / square
        highest = (1.0 / self.sizes[largest] - 0.5 * self.counts[largest] / square) / 2.0
        point = float(optimize.brentq(lambda at: self._slope(at) - square, lowest, highest, rtol=1e-12))
        left = 1.0 - 2.0 * point * self.sizes
        exponent = point * square + 0.5 * float(self.counts @ np.log(left))
        w = math.copysign(math.sqrt(2.0 * exponent), point)
        v = point * math.sqrt(2.0 * float(self.counts @ (self.sizes / left) ** 2))
        return float(special.ndtr(-(w + math.log(v / w) / w)))

    def _slope(self, at: float) -> float:
        """Return the derivative of the cumulants' generating function."""
        return float(self.counts @ (self.sizes / (1.0 - 2.0 * at * self.sizes)))


def _principal(effects: Floats) -> tuple[Floats, Floats]:
    """Return orthonormal directions of effects, shape (n, r), and their variances, shape (r,)."""
    if effects.shape[1] == 0:
        return effects, np.zeros(0)
    axes, singular, _ = np.linalg.svd(effects, full_matrices=False)
    variances = singular**2
    kept = variances > _NEGLIGIBLE * max(float(variances.max()), 1e-300)
    return axes[:, kept], variances[kept]
