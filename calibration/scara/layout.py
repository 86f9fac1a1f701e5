"""Order, names and gauge of the parameters of both models (Eqs 4 and 6)."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from catseye.calibration.core.arguments import require_increasing, require_one_of, require_shape
from catseye.calibration.core.gauge import Gauge
from catseye.calibration.core.model import Parameters
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.extension import Term

ModelName = Literal["conventional", "error-map"]

GAUGE = "mean of theta1 map = 0"
"""Distances cannot see a rotation of everything about J1; the mean over both directions fixes it."""

_MOST_NAMED = 12
"""Parameters that an error text lists."""

UNSETTLED = (
    "check the rough reflector places and the nominal links in the cell file, "
    "and the reflector names of the points, and whether sigma_mm is in mm"
)


@dataclass(frozen=True)
class Layout:
    """Where each parameter stands in the vector: links, maps or θ20, further terms, reflectors, dead paths.

    Attributes:
        model: which model.
        nodes1_rad: nodes of the J1 map, shape (m1,); empty for the conventional model.
        nodes2_rad: nodes of the J2 map, shape (m2,); empty for the conventional model.
        reflector_names: names of the reflectors.
        dead_paths: (reflector name, segment) of each dead path.
        terms: functions beyond the maps, each with a coefficient.
    """

    model: ModelName
    nodes1_rad: Floats
    nodes2_rad: Floats
    reflector_names: tuple[str, ...]
    dead_paths: tuple[tuple[str, int], ...]
    terms: tuple[Term, ...] = ()

    def __post_init__(self) -> None:
        require_one_of(ModelName, self.model, "model")
        for name in ("nodes1_rad", "nodes2_rad"):
            if self.model == "error-map":
                require_increasing(getattr(self, name), name)
            else:
                require_shape(getattr(self, name), (0,), f"{name} of the {self.model} model")

    @property
    def arm_size(self) -> int:
        """Number of parameters of the arm: links, maps or θ20, further terms."""
        return 2 + 2 * self.nodes1_rad.size + self._size2 + len(self.terms)

    def of_arm(self) -> "Layout":
        """Return the layout of the arm alone, without reflectors and dead paths."""
        return replace(self, reflector_names=(), dead_paths=())

    @property
    def size(self) -> int:
        """Number of all parameters."""
        return self.arm_size + 2 * len(self.reflector_names) + len(self.dead_paths)

    @property
    def map1(self) -> slice:
        """J1 map: positive table, then negative table."""
        return slice(2, 2 + 2 * self.nodes1_rad.size)

    @property
    def map2(self) -> slice:
        """J2 map: positive table, then negative table; θ20 for the conventional model."""
        first = self.map1.stop
        return slice(first, first + self._size2)

    @property
    def _size2(self) -> int:
        return 1 if self.model == "conventional" else 2 * self.nodes2_rad.size

    @property
    def extension(self) -> slice:
        """Coefficients of the further terms."""
        return slice(self.map2.stop, self.arm_size)

    @property
    def reflectors(self) -> slice:
        """Places of the reflectors: x and y of each, in turn."""
        return slice(self.arm_size, self.arm_size + 2 * len(self.reflector_names))

    @property
    def dead_path(self) -> slice:
        """Places of the dead paths, mm, one for each reflector and segment."""
        return slice(self.reflectors.stop, self.size)

    def names(self) -> list[str]:
        """Return a name for each parameter, as messages use it."""
        arm = ["L1", "L2"]
        if self.model == "conventional":
            arm.append("θ20")
        else:
            arm += _table_names("θ1", self.nodes1_rad) + _table_names("θ2", self.nodes2_rad)
        arm += [term.name for term in self.terms]
        places = [f"{name}.{axis}" for name in self.reflector_names for axis in "xy"]
        return arm + places + [f"dead path {name}/{segment}" for name, segment in self.dead_paths]

    def units(self) -> list[str]:
        """Return the unit of each parameter."""
        angles = self.map2.stop - self.map1.start
        terms = ["rad" if term.angular else "mm" for term in self.terms]
        return ["mm"] * 2 + ["rad"] * angles + terms + ["mm"] * (self.size - self.arm_size)

    def parameters(self) -> Parameters:
        """Return names, units and gauge, and what to do when the distances do not determine them."""
        return Parameters(
            tuple(self.names()), tuple(self.units()), self.gauge_basis(), UNSETTLED, self.undetermined
        )

    def undetermined(self, directions: list[list[str]]) -> str:
        """Return what to measure when combinations of parameters, given by their names, are not determined."""
        own = {term.name for term in self.terms if term.of_own_joint}
        periodic = [
            name for name in self.names() if any(name in own.intersection(names) for names in directions)
        ]
        of_j4 = {term.name for term in self.terms if term.source == "theta4"}
        beams = [name for name in self.names() if any(name in of_j4.intersection(one) for one in directions)]
        rest = [names for names in directions if not (own | of_j4).intersection(names)]
        single = [names[0] for names in rest if len(names) == 1]
        mixed = [", ".join(names) for names in rest if len(names) > 1]
        parts = []
        if periodic:
            parts.append(
                f"at these commands the maps absorb {_shortened(periodic)}: measure between the nodes, at angles "
                "that differ within the period, or leave the terms out"
            )
        if beams:
            parts.append(
                f"what {_shortened(beams)} would do to these distances, dead paths, links or maps do as well, even "
                "where the interferometer was turned by half a turn: leave the terms out, or measure with it turned "
                "by about a quarter turn, too"
            )
        if single:
            parts.append(
                f"no point touches {_shortened(single)}: approach these nodes from these directions, "
                "or leave the nodes out of the cell file's [measurement]"
            )
        parts += [
            f"the points cannot separate {text}: vary the commands of both joints more, or add a reflector"
            for text in mixed
        ]
        return "the points do not determine every parameter: " + "; ".join(parts)

    @property
    def gauge(self) -> Gauge:
        """Mean of the J1 map; the conventional model needs none, for J1's command angles fix the frame."""
        return Gauge.none(self.size) if self.model == "conventional" else Gauge.mean_of(self.map1, self.size)

    def gauge_basis(self) -> Floats:
        """Return an orthonormal basis of the steps that keep the gauge, shape (size, free)."""
        return self.gauge.basis


def _table_names(joint: str, nodes_rad: Floats) -> list[str]:
    angles = np.rad2deg(nodes_rad)
    return [f"Δ{joint}({angle:g}°, {sign})" for sign in "+−" for angle in angles]


def _shortened(names: list[str]) -> str:
    shown, further = ", ".join(names[:_MOST_NAMED]), len(names) - _MOST_NAMED
    return shown if further <= 0 else f"{shown} and {further} more"
