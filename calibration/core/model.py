"""What a model shows of itself: named parameters, rows that depend on them, and the errors of the rows."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from catseye.calibration.core.budget import Shared, White
from catseye.calibration.core.repeats import Repeats
from catseye.calibration.core.types import Floats
from catseye.calibration.core.whitening import Whitening


def not_separable(directions: list[list[str]]) -> str:
    """Return a sentence about null directions, each given as the names of its parameters."""
    listed = "; ".join(", ".join(names) for names in directions)
    return f"the rows do not determine every parameter: {listed}"


@dataclass(frozen=True)
class Parameters:
    """What a model estimates, p parameters.

    Attributes:
        names: as messages use them.
        basis: orthonormal steps that keep the gauge, shape (p, free).
        unsettled: advice for an iteration that does not settle.
        undetermined: sentence about null directions: what to measure or to leave out.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    basis: Floats
    unsettled: str = "check the starting values"
    undetermined: Callable[[list[list[str]]], str] = not_separable


class Model(Protocol):
    """n rows, each a residual (predicted minus measured, mm) that depends on p parameters."""

    @property
    def parameters(self) -> Parameters:
        """What is estimated."""
        ...

    @property
    def weights(self) -> Floats:
        """Reciprocal white standard uncertainties, 1/mm, shape (n,); ones when none are stated."""
        ...

    @property
    def stated(self) -> bool:
        """The weights are stated uncertainties, not ones."""
        ...

    @property
    def repeats(self) -> Repeats:
        """Which of the n rows measure the same."""
        ...

    def residuals(self, values: Floats) -> Floats:
        """Return the residuals at values of shape (p,), mm, shape (n,)."""
        ...

    def jacobian(self, values: Floats) -> Floats:
        """Return the derivatives of the residuals, shape (n, p)."""
        ...

    def white(self, values: Floats) -> tuple[White, ...]:
        """Return the errors that differ from row to row."""
        ...

    def shared(self, values: Floats) -> tuple[Shared, ...]:
        """Return the errors that rows have in common."""
        ...


def whitening_at(model: Model, values: Floats) -> Whitening:
    """Return what makes the rows independent, with the shared errors at values of shape (p,)."""
    return Whitening.of(model.weights, model.shared(values))
