"""Terms beyond the error map: known functions of the commands, each with a coefficient to identify.

Periodic errors of a transmission, crosstalk between the joints, what J4 adds to a distance, growth of the links: each
is a sum of terms, and every term adds to one quantity of the model.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np

from catseye.calibration.core.arguments import require_count, require_one_of
from catseye.calibration.core.types import Floats

Target = Literal["theta1", "theta2", "link1", "link2", "length"]
"""What a term adds to: a joint angle, rad; a link, mm; the measured distance, mm."""

Source = Literal["theta1", "theta2", "theta4", "elapsed"]
"""What a term is a function of: a command angle, J4's own angle, the elapsed share of the run."""

Part = Literal["cos", "sin", "linear"]

Joint = Literal[1, 2]

_ROUNDING = 1e-11
"""Values of cosine and sine below this are zero."""

_SYMBOLS = {"theta1": "θ1", "theta2": "θ2", "theta4": "θ4", "elapsed": "t"}
_TARGETS = {"theta1": "Δθ1", "theta2": "Δθ2", "link1": "ΔL1", "link2": "ΔL2", "length": "Δd"}


@dataclass(frozen=True)
class Term:
    """One function with a coefficient.

    Attributes:
        target: what it adds to.
        source: what it is a function of.
        part: cosine or sine of order × angle, or the elapsed share itself (-1/2 ... 1/2).
        order: multiple of the angle.
    """

    target: Target
    source: Source
    part: Part
    order: int = 1

    def __post_init__(self) -> None:
        require_one_of(Target, self.target, "target of a term")
        require_one_of(Source, self.source, "source of a term")
        require_one_of(Part, self.part, "part of a term")
        require_count(self.order, "order of a term", 0)

    @property
    def name(self) -> str:
        """What messages call its coefficient."""
        argument = _SYMBOLS[self.source] if self.order == 1 else f"{self.order}{_SYMBOLS[self.source]}"
        function = argument if self.part == "linear" else f"{self.part} {argument}"
        return f"{_TARGETS[self.target]} {function}"

    @property
    def of_own_joint(self) -> bool:
        """It adds to the joint whose angle it is a function of: at its nodes the joint's map does the same."""
        return self.target == self.source

    @property
    def angular(self) -> bool:
        """The coefficient is an angle, rad; otherwise a length, mm."""
        return self.target in {"theta1", "theta2"}


def periodic(joint: Joint, orders: tuple[int, ...]) -> tuple[Term, ...]:
    """Return periodic errors of a joint's transmission: harmonics of its own angle between the nodes."""
    require_one_of(Joint, joint, "joint")
    source: Source = "theta1" if joint == 1 else "theta2"
    return waves("theta1" if joint == 1 else "theta2", source, orders)


def crosstalk(orders: tuple[int, ...] = (1, 2)) -> tuple[Term, ...]:
    """Return what each joint's deviation owes to the angle of the other (the paper's future work)."""
    return waves("theta1", "theta2", orders) + waves("theta2", "theta1", orders)


def j4_map(orders: tuple[int, ...] = (2, 3, 4, 5, 6)) -> tuple[Term, ...]:
    """Return what J4's axis adds to a distance where it stands at an angle.

    The coefficients are those of the first mounting. Turned on the flange, the interferometer sees the other side of
    the same motion. Orders 0 and 1 cannot be separated from dead paths, L2 and the mean of the J2 map in any
    mounting, so they are not part of it (docs/uncertainty.md derives it).
    """
    return waves("length", "theta4", orders)


def thermal_drift() -> tuple[Term, ...]:
    """Return a linear growth of both links over the measurement."""
    return (Term("link1", "elapsed", "linear"), Term("link2", "elapsed", "linear"))


def waves(target: Target, source: Source, orders: tuple[int, ...]) -> tuple[Term, ...]:
    """Return cosine and sine of each order."""
    return tuple(
        term
        for order in orders
        for term in (Term(target, source, "cos", order), Term(target, source, "sin", order))
    )


def term_values(
    terms: tuple[Term, ...],
    sources: dict[Source, Floats | None],
    rows: int,
    mount_rad: Floats | None = None,
) -> Floats:
    """Return the functions' values.

    Args:
        terms: k functions.
        sources: what they are functions of, shape (rows,) each; one that is None gives zeros: it does not act there.
            For θ4 it is the angle of the beam against link 2.
        mount_rad: by how much the interferometer is turned on J4's flange, shape (rows,); None for 0. J4 itself
            stands at the beam's angle less that, and its axis moves along the beam by the cosine of it.

    Returns:
        Values, shape (rows, k).
    """
    values = np.zeros((rows, len(terms)))
    for i, term in enumerate(terms):
        source = sources[term.source]
        if source is None:
            continue
        if term.source == "theta4" and mount_rad is not None:
            source = source - mount_rad
        match term.part:
            case "cos":
                values[:, i] = np.cos(term.order * source)
            case "sin":
                values[:, i] = np.sin(term.order * source)
            case "linear":
                values[:, i] = source
        if term.source == "theta4" and mount_rad is not None:
            values[:, i] *= np.cos(mount_rad)
    # Zeros of a sine are rounding at the angles of a grid; scaled up they would pass for a measurement.
    values[np.abs(values) < _ROUNDING] = 0.0
    return values
