"""The error budget of a distance: contributors and what each is common to.

Distances that share an error do not average it out. Each contributor therefore says what it is common to: nothing
(every reading draws anew), the pose, the angle of an axis, neighbouring times, the segment, or the whole measurement.
What contributors do to rows is `catseye.calibration.scara.budget_effects`.
"""

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from catseye.calibration.core.arguments import (
    require_count,
    require_not_negative,
    require_one_of,
    require_positive,
)
from catseye.calibration.core.budget import Distribution
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.scara.drift_process import octaves, shares

Kind = Literal[
    "length", "scale", "position", "angle", "between-nodes", "radial", "direction", "links", "reflector"
]
"""What is uncertain: the distance, its scale, the position of the J4 axis, a joint's angle, what lies between the
nodes of its map, the place of a joint's axis, the direction of the beam, how much both links have grown, the place of
a reflector."""

Correlation = Literal["reading", "pose", "axis-angle", "time", "segment", "common"]
"""What shares one and the same error: nothing, a pose, an angle of an axis, a time (and less and less of it what is
measured earlier or later), a segment, the whole measurement."""

Axis = Literal["j1", "j2", "j4"]

_ALLOWED: dict[Kind, tuple[Correlation, ...]] = {
    "length": ("reading", "pose", "axis-angle", "time", "common"),
    "scale": ("reading", "time", "common"),
    "position": ("reading", "pose", "common"),
    "angle": ("reading", "axis-angle", "common"),
    "between-nodes": ("axis-angle",),
    "radial": ("axis-angle",),
    "direction": ("reading",),
    "links": ("time",),
    "reflector": ("segment",),
}

_OF_ARM: dict[Kind, tuple[Correlation, ...]] = {
    "position": ("reading", "pose"),
    "angle": ("reading",),
    "between-nodes": ("axis-angle",),
    "radial": ("axis-angle",),
    "links": ("time",),
}
"""What moves the arm itself, again wherever it goes. An angle that errs the same way every time is in its map."""


_PASSING: tuple[Correlation, ...] = ("time", "segment")


@dataclass(frozen=True)
class Contributor:
    """One line of the budget.

    Attributes:
        name: what a reader calls it.
        kind: what is uncertain.
        u: standard uncertainty: mm (length, position, radial, reflector in x and in y), rad (angle, between-nodes,
            direction), a share (scale, links); of what changes with time, its rms over the measurement.
        correlation: what shares the error.
        axis: whose angle repeats it (axis-angle), or whose angle is uncertain (angle).
        orders: harmonics 1…orders of the angle share an axis-angle error evenly, as far as is known beforehand; what
            changes with time has up to so many half periods in the measurement.
        dof: degrees of freedom of u.
        spectrum: variance of each part over what is stated for it, as distances have shown it: of each harmonic, of
            all that lies between nodes, or of each octave of a drift; empty as long as none have been asked.
    """

    name: str
    kind: Kind
    u: float
    correlation: Correlation = "reading"
    axis: Axis | None = None
    distribution: Distribution = "normal"
    orders: int = 5
    dof: float = math.inf
    spectrum: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        require_one_of(Kind, self.kind, f"{self.name}: kind")
        require_one_of(Correlation, self.correlation, f"{self.name}: correlation")
        require_one_of(Distribution, self.distribution, f"{self.name}: distribution")
        require_not_negative(self.u, f"{self.name}: u")
        require_count(self.orders, f"{self.name}: orders")
        require_positive(self.dof, f"{self.name}: dof", infinite=True)
        for ratio in self.spectrum:
            require_not_negative(ratio, f"{self.name}: spectrum")
        if self.axis is not None:
            require_one_of(Axis, self.axis, f"{self.name}: axis")
        self._require_combination()

    def _require_combination(self) -> None:
        if self.correlation not in _ALLOWED[self.kind]:
            raise ArgumentError(
                f"{self.name}: kind {self.kind} cannot be correlated per {self.correlation}; "
                f"possible: {', '.join(_ALLOWED[self.kind])}"
            )
        needed = self.kind in {"radial", "angle", "between-nodes"} or self.correlation == "axis-angle"
        if needed and self.axis is None:
            raise ArgumentError(f"{self.name}: say which axis: j1, j2 or j4")
        if len(self.spectrum) not in {0, self.parts}:
            raise ArgumentError(
                f"{self.name}: a spectrum of {len(self.spectrum)} values instead of {self.parts}; an axis-angle "
                "error has one for each of its orders, a ripple between nodes a single one, what changes with time "
                "one for each octave of its orders, any other error none"
            )
        if self.kind == "between-nodes" and self.axis == "j4":
            raise ArgumentError(f"{self.name}: J4 has no map, and so no nodes: say j1 or j2")
        if self.kind == "angle" and self.axis == "j4":
            raise ArgumentError(
                f"{self.name}: the angle of J4 acts on the direction of the beam: kind direction"
            )

    @property
    def parts(self) -> int:
        """How many parts it has whose sizes distances can show."""
        match self.correlation:
            case "axis-angle":
                return 1 if self.kind == "between-nodes" else self.orders
            case "time":
                return int(octaves(self.orders)[-1]) + 1
        return 0

    @property
    def assumed(self) -> bool:
        """Whether nobody knows its size beforehand."""
        return self.kind == "between-nodes" or self.correlation == "time"

    @property
    def sources(self) -> int:
        """How many sources of unit variance it has where it comes again (`Budget.repeating`)."""
        columns = 2 if self.kind in {"position", "radial"} else 1
        return columns * (2 * self.orders if self.correlation == "axis-angle" else 1)

    @property
    def open(self) -> bool:
        """Distances have not been asked yet how large its parts are."""
        return self.parts > 0 and not self.spectrum and self.u > 0.0

    @property
    def shares(self) -> tuple[float, ...]:
        """Share of each order in u²; they add up to 1 as long as no distances have been asked."""
        if self.correlation == "time":
            shown = np.array(self.spectrum or (1.0,) * self.parts)[octaves(self.orders)]
            return tuple((shown * shares(self.orders)).tolist())
        return tuple(ratio / self.orders for ratio in self.spectrum or (1.0,) * self.orders)


IDENTIFIED = "identified parameters"
"""What the part of a prediction's uncertainty is called that the identification leaves."""

INSTRUMENT = "instrument"
"""What the part of a comparison's uncertainty is called that comes from the instrument compared with."""


@dataclass(frozen=True)
class Budget:
    """All contributors, each under a name of its own.

    Raises:
        ArgumentError: two have one name, or one has the name of a part that is added to the budget.
    """

    contributors: tuple[Contributor, ...]

    def __post_init__(self) -> None:
        names = [one.name for one in self.contributors]
        twice = list(dict.fromkeys(name for name in names if names.count(name) > 1))
        if twice:
            raise ArgumentError(
                f"the budget has more than one contributor named {', '.join(twice)}: give each a name of its own, "
                "for parts of an uncertainty are distinguished by their names"
            )
        for name in (IDENTIFIED, INSTRUMENT):
            if name in names:
                raise ArgumentError(
                    f"a contributor is named {name}, as the part of an uncertainty that is added to the budget: "
                    "give it another name"
                )

    @property
    def white(self) -> tuple[Contributor, ...]:
        """Contributors that differ from reading to reading."""
        return tuple(one for one in self.contributors if one.correlation == "reading")

    @property
    def systematic(self) -> tuple[Contributor, ...]:
        """Contributors that several distances have in common."""
        return tuple(one for one in self.contributors if one.correlation != "reading")

    @property
    def follows_j4(self) -> bool:
        """Whether an error that distances have in common comes back with J4's own angle."""
        return any(one.axis == "j4" and one.u > 0.0 for one in self.systematic)

    @property
    def of_arm(self) -> "Budget":
        """Contributors that move the arm itself, and not what measures it."""
        return Budget(tuple(one for one in self.contributors if one.correlation in _OF_ARM.get(one.kind, ())))

    @property
    def repeating(self) -> tuple[Contributor, ...]:
        """Errors that come again after the measurement, the same at the same angles."""
        return tuple(
            one
            for one in self.contributors
            if one.correlation in {"axis-angle", "common"} and one.kind != "between-nodes" and one.u > 0.0
        )

    @property
    def passing(self) -> "Budget":
        """Contributors of the measurement's own times and segments: those of another measurement differ."""
        return Budget(tuple(one for one in self.contributors if one.correlation in _PASSING))

    @property
    def lasting(self) -> "Budget":
        """All others."""
        return Budget(tuple(one for one in self.contributors if one.correlation not in _PASSING))
