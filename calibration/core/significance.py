"""Sums of squares: what they are expected to be, F-tests of nested models, information criteria."""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats

SIGNIFICANCE = 0.01
"""A test rejects when its probability is below this."""

_TINY = 1e-300
"""Keeps a ratio finite where nothing is left over."""


@dataclass(frozen=True)
class Expected:
    """A sum of squares of white and systematic errors: its mean and its effective degrees of freedom.

    Attributes:
        mean: expected sum of squares, in squares of the white uncertainty.
        dof: degrees of freedom of the χ² distribution of the same mean and spread.
    """

    mean: float
    dof: float

    @classmethod
    def of(cls, dof: int, effects: Floats) -> "Expected":
        """Return the expectation for `dof` white errors and projected effects of shape (n, m) (Satterthwaite)."""
        return cls.of_products(dof, smaller_product(effects))

    @classmethod
    def of_products(cls, dof: int, inner: Floats) -> "Expected":
        """Return the same from the effects' products, EᵀE or EEᵀ."""
        mean = dof + float(np.trace(inner))
        return cls(mean, mean**2 / (dof + 2.0 * float(np.trace(inner)) + float(np.sum(inner**2))))

    def minus(self, part: "Expected", dof: int, inner: Floats) -> "Expected":
        """Return the expectation of the difference of two nested sums of squares."""
        mean = self.mean - part.mean
        spread = dof + 2.0 * float(np.trace(inner)) + float(np.sum(inner**2))
        return Expected(mean, mean**2 / spread)

    def probability(self, square: float) -> float:
        """Return the probability of a sum of squares this large."""
        # Whoever only lists procedures imports this module too.
        from scipy import special

        return float(special.chdtrc(self.dof, square * self.dof / self.mean))


def smaller_product(effects: Floats) -> Floats:
    """Return EᵀE or EEᵀ: both have the same trace and the same sum of squares."""
    return effects.T @ effects if effects.shape[0] > effects.shape[1] else effects @ effects.T


class Judged:
    """What a test says at the level of significance; base of dataclasses with its probabilities.

    Attributes:
        probability: of what was seen, or more, for white errors.
        probability_stated: the same with the stated shared errors.
    """

    probability: float
    probability_stated: float

    @property
    def significant(self) -> bool:
        """White errors alone do not look like this."""
        return self.probability < SIGNIFICANCE

    @property
    def explained(self) -> bool:
        """The stated shared errors account for it."""
        return self.probability_stated >= SIGNIFICANCE


@dataclass(frozen=True)
class FTest:
    """An F-test of nested models, for white errors and with the stated systematic contributors.

    Attributes:
        ratio: F.
        probability: of a ratio this large, white errors.
        probability_stated: of a ratio this large, stated contributors.
        scale: sum of squares that is left over its expectation.
        explained_um: standard deviation of a row that the larger model explains, µm.
    """

    ratio: float
    probability: float
    probability_stated: float
    scale: float
    explained_um: float


def f_test(
    gain: float, gain_expected: Expected, rank: int, rest: float, rest_expected: Expected, rest_dof: int
) -> FTest:
    """Test a gain of a larger model against what is left.

    Args:
        gain: sum of squares that it explains.
        gain_expected: expectation of the gain for the stated uncertainties.
        rest: sum of squares that it leaves.
        rest_expected: its expectation for the stated uncertainties.
        rest_dof: degrees of freedom that it leaves.
    """
    from scipy import special

    left = max(rest / rest_dof, _TINY)
    ratio = gain / rank / left
    scale = max(rest, _TINY) / rest_expected.mean
    # Below zero, where the expectation is a difference of large effects, F has no distribution.
    stated = max(gain / gain_expected.mean / scale, 0.0)
    size = max(gain - rank * left, 0.0)
    return FTest(
        ratio,
        float(special.fdtrc(rank, rest_dof, ratio)),
        float(special.fdtrc(gain_expected.dof, rest_expected.dof, stated)),
        scale,
        float(np.sqrt(size)),
    )


def adjusted(probability: float, tests: int) -> float:
    """Return a probability that counts how many tests were looked at (Šidák)."""
    if probability >= 1.0:
        return 1.0
    return float(-np.expm1(tests * np.log1p(-probability)))


def aicc(square: float, rows: int, free: int) -> float:
    """Return Akaike's criterion with the correction for few rows (Hurvich and Tsai).

    Args:
        square: weighted sum of squares of the residuals.
        free: free parameters; the scale of the scatter counts as one more.
    """
    k = free + 1
    if rows - k - 1 < 1:
        return math.inf
    return _deviance(square, rows) + 2.0 * k + 2.0 * k * (k + 1) / (rows - k - 1)


def bic(square: float, rows: int, free: int) -> float:
    """Return Schwarz's criterion; arguments as those of `aicc`."""
    return _deviance(square, rows) + (free + 1) * math.log(rows)


def _deviance(square: float, rows: int) -> float:
    return rows * math.log(max(square, 1e-300) / rows)
