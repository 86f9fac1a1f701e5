"""One quantity in two results, and what is said of all that differ."""

import math
from dataclasses import dataclass

from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import EXPANDED, SHARE_EXPECTED, fixed, number

_SIGNED = fixed(1, signed=True)


@dataclass(frozen=True)
class Difference:
    """One quantity in both results.

    Attributes:
        name: of the quantity.
        unit: of all values.
        first: value of the first result.
        second: value of the second result.
        u_first: standard uncertainty of the first.
        u_second: standard uncertainty of the second.
        common: covariance of both, by errors that are the same in both; 0 where they count as independent.
    """

    name: str
    unit: str
    first: float
    second: float
    u_first: float
    u_second: float
    common: float = 0.0

    @property
    def difference(self) -> float:
        """Second minus first."""
        return self.second - self.first

    @property
    def u(self) -> float:
        """Standard uncertainty of the difference."""
        return math.sqrt(max(self.u_first**2 + self.u_second**2 - 2.0 * self.common, 0.0))

    @property
    def normalised(self) -> float | None:
        """Difference in combined standard uncertainties; None where none is stated."""
        return self.difference / self.u if self.u > 0.0 else None


def difference_statement(within: int, count: int, what: str, largest: tuple[str, float]) -> Statement:
    """Return how many differences lie within what their uncertainties account for.

    Args:
        what: of them, as a plural.
        largest: name and size of the largest, in combined standard uncertainties.
    """
    share, (name, size) = within / count, largest
    return Statement(
        Sign.GOOD if share >= SHARE_EXPECTED else Sign.BAD,
        f"{within} of {count} {what} lie within {EXPANDED:g} combined standard uncertainties "
        f"({100.0 * share:.0f} %, 95 % expected); the largest is {number(size, _SIGNED)} u, {name}.",
    )
