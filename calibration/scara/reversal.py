"""What J4 did, as distances show it that were measured with the interferometer in two mountings.

Turned by half a turn on J4's flange, the interferometer sees the other side of J4: odd orders of the motion of J4's
axis, and odd orders of what J4 adds to the length itself, change sign in the distance, and no map does.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Contributor
from catseye.calibration.scara.budget_effects import described
from catseye.calibration.scara.extension import waves
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.known_sources import contributors_asked, known_sources


@dataclass(frozen=True)
class SeparatedOrder:
    """An order of J4's angle in the distance that changes sign between the mountings.

    Attributes:
        contributor: of the budget, whose order it is.
        order: multiple of J4's angle.
        cosine_mm: amplitude of the cosine, in the first mounting.
        sine_mm: amplitude of the sine.
        covariance_mm2: of both, shape (2, 2).
    """

    contributor: str
    order: int
    cosine_mm: float
    sine_mm: float
    covariance_mm2: Floats

    @property
    def amplitude_mm(self) -> float:
        """Amplitude of the wave."""
        return float(np.hypot(self.cosine_mm, self.sine_mm))

    @property
    def u_parts_mm(self) -> tuple[float, float]:
        """Standard uncertainties of cosine and sine."""
        return float(np.sqrt(self.covariance_mm2[0, 0])), float(np.sqrt(self.covariance_mm2[1, 1]))

    @property
    def u_mm(self) -> float:
        """Standard uncertainty of the amplitude, along the wave found."""
        amplitude = self.amplitude_mm
        along = (
            np.array([self.cosine_mm, self.sine_mm]) / amplitude if amplitude > 0.0 else np.array([1.0, 0.0])
        )
        return float(np.sqrt(along @ self.covariance_mm2 @ along))


def separated_orders(identified: Identification) -> tuple[SeparatedOrder, ...]:
    """Return the orders of J4 that two mountings have separated from the maps; none where it was not turned.

    Orders that are identified as terms are not among them: they have coefficients of their own.
    """
    if not identified.reversed_mountings:
        return ()
    asked = [
        one
        for one in contributors_asked(identified)
        if one.axis == "j4" and one.correlation == "axis-angle" and one.u > 0.0
    ]
    return tuple(order for one in asked for order in _orders(identified, one))


def _orders(identified: Identification, contributor: Contributor) -> list[SeparatedOrder]:
    sources, covariance = known_sources(identified, contributor)
    terms = identified.layout.terms
    found = []
    # An odd order k of an axis' motion shows in a distance as the even orders k - 1 and k + 1.
    orders = contributor.orders
    for order in range(1, orders + 1, 2) if contributor.kind == "length" else range(2, orders + 2, 2):
        wave = waves("length", "theta4", (order,))
        if contributor.kind == "radial" and set(wave) <= set(terms):
            continue
        share = described(contributor, wave)
        cosine, sine = (share @ sources).tolist()
        found.append(SeparatedOrder(contributor.name, order, cosine, sine, share @ covariance @ share.T))
    return found
