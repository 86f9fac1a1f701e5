"""Sums of squares of independent errors: tests of nested models, information criteria."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

SIGNIFICANCE = 0.01
"""A test rejects when its probability is below this."""

_TINY = 1e-300
"""Keeps a ratio finite where nothing is left over."""


class Judged:
    """What a test says at the level of significance; base of dataclasses with its probability.

    Attributes:
        probability: of what was seen, or more, when there is nothing but the stated errors.
    """

    probability: float

    @property
    def significant(self) -> bool:
        """The stated errors alone do not look like this."""
        return self.probability < SIGNIFICANCE


@dataclass(frozen=True)
class FTest:
    """An F-test of nested models on whitened rows.

    Attributes:
        ratio: F.
        probability: of a ratio this large when the larger model explains nothing.
        scale: mean square that is left.
        explained: root of the sum of squares that the larger model explains beyond scatter.
    """

    ratio: float
    probability: float
    scale: float
    explained: float


def f_test(gain: float, rank: int, rest: float, rest_dof: int) -> FTest:
    """Test a gain of a larger model against what is left.

    Args:
        gain: sum of squares that it explains.
        rank: degrees of freedom that it takes.
        rest: sum of squares that it leaves.
        rest_dof: degrees of freedom that it leaves.
    """
    # Whoever only lists procedures imports this module too.
    from scipy import special

    left = max(rest / rest_dof, _TINY)
    ratio = gain / rank / left
    size = max(gain - rank * left, 0.0)
    return FTest(ratio, float(special.fdtrc(rank, rest_dof, ratio)), left, float(np.sqrt(size)))


def chi2_probability(square: float, dof: int) -> float:
    """Return the probability of a sum of squares this large, of so many independent errors of unit variance."""
    from scipy import special

    return float(special.chdtrc(dof, square))


def adjusted(probability: float, tests: float) -> float:
    """Return a probability that counts how many tests were looked at (Šidák)."""
    if probability >= 1.0:
        return 1.0
    return float(-np.expm1(tests * np.log1p(-probability)))


def holm_factors(probabilities: Sequence[float]) -> list[float]:
    """Return by what each of several tests raises its probability because the others were made too (Holm).

    With all raised, one of them is significant by chance as rarely as a single test is.
    """
    count, order = len(probabilities), np.argsort(probabilities, kind="stable").tolist()
    factors, largest = [1.0] * count, 0.0
    for place, test in enumerate(order):
        probability = probabilities[test]
        largest = max(largest, (count - place) * probability)
        factors[test] = largest / probability if probability > 0.0 else float(count - place)
    return factors


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
