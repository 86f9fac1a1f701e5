"""F-tests of nested models, and probabilities that count how often one has looked."""

from dataclasses import dataclass

import numpy as np
from scipy import special

from catseye.calibration.core.fit_statistics import Expected

_TINY = 1e-300
"""Keeps a ratio finite where nothing is left over."""


@dataclass(frozen=True)
class FTest:
    """An F-test of nested models, for white errors and with the stated systematic contributors.

    Attributes:
        ratio: F.
        probability: of a ratio this large, white errors.
        probability_stated: of a ratio this large, stated contributors.
        scale: sum of squares that is left over what the stated contributors let expect.
        explained_um: standard deviation of a distance that the larger model explains, µm.
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
        gain_expected: what the stated uncertainties let the gain expect.
        rank: parameters that it has more.
        rest: sum of squares that it leaves.
        rest_expected: what the stated uncertainties let that expect.
        rest_dof: degrees of freedom that it leaves.
    """
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
