"""Values of one arm in several results, against one of them, whatever system they are of."""

from collections.abc import Sequence
from dataclasses import dataclass

from catseye.app.results.difference import Difference
from catseye.app.results.figures import Figure
from catseye.app.results.model import Origin
from catseye.app.results.numbers import EXPANDED
from catseye.app.results.stored_results import StoredResult


@dataclass(frozen=True)
class Value:
    """A value in one result.

    Attributes:
        u: its standard uncertainty.
        change: against the baseline; None in the baseline, and where the baseline has no such value.
    """

    value: float
    u: float
    change: Difference | None


@dataclass(frozen=True)
class Course:
    """One quantity over all results.

    Attributes:
        name: of the quantity.
        unit: of its values.
        judged: it belongs to the arm; what stands beside it may be moved.
        values: one a result, in their order; None where a result does not have it.
    """

    name: str
    unit: str
    judged: bool
    values: tuple[Value | None, ...]

    @property
    def changes(self) -> dict[int, Difference]:
        """Changes against the baseline, by the number of the result."""
        return {
            number: each.change
            for number, each in enumerate(self.values)
            if each is not None and each.change is not None
        }

    def largest(self) -> float:
        """Return the largest change in standard uncertainties of the difference; 0 without any."""
        return max((abs(change.normalised or 0.0) for change in self.changes.values()), default=0.0)


@dataclass(frozen=True)
class Trend:
    """All results of one arm, oldest first.

    Attributes:
        arm: whose they are.
        results: with their times.
        baseline: which of them the others are held against.
        courses: of all quantities.
        figures: of the system's own kind.
        remarks: what a reader has to know.
        origin: of all results together.
    """

    arm: str
    results: tuple[StoredResult, ...]
    baseline: int
    courses: tuple[Course, ...]
    figures: tuple[Figure, ...]
    remarks: tuple[str, ...]
    origin: Origin

    def changes(self, number: int) -> list[Difference]:
        """Return the changes of the arm's own quantities in one result that can be judged."""
        found = (one.changes.get(number) for one in self.courses if one.judged)
        return [change for change in found if change is not None and change.normalised is not None]

    def largest(self, number: int) -> tuple[str, float] | None:
        """Return the change of a result that is largest in u of the difference; None where there is none."""
        sizes = [(change.name, change.normalised or 0.0) for change in self.changes(number)]
        return max(sizes, key=lambda one: abs(one[1]), default=None)

    def within(self, number: int) -> int:
        """Return how many changes of a result lie within two standard uncertainties."""
        return sum(abs(change.normalised or 0.0) <= EXPANDED for change in self.changes(number))


def course(name: str, unit: str, found: Sequence[tuple[float, float] | None], baseline: int) -> Course:
    """Return a quantity whose results count as independent.

    Args:
        found: its value and standard uncertainty in each result; None where a result does not have it.
    """
    first = found[baseline]

    def change(number: int, other: tuple[float, float]) -> Difference | None:
        if first is None or number == baseline:
            return None
        return Difference(name, unit, first[0], other[0], first[1], other[1])

    values = (None if one is None else Value(*one, change(number, one)) for number, one in enumerate(found))
    return Course(name, unit, True, tuple(values))
