"""[uncertainty]: what a distance is good for. The default is Table 2 of the SCARA paper with the laser of [air]."""

import math
from typing import Annotated, Any, Final, Literal, Self

from pydantic import Field, StringConstraints, ValidationInfo, model_validator

from catseye.app.cell.section import RECORD, NotNegative, Section
from catseye.calibration.air import HE_NE_RELATIVE_U
from catseye.calibration.core.budget import Distribution
from catseye.calibration.scara.budget import (
    Budget,
    Contributor,
    Correlation,
    Kind,
)

_UNITS: dict[str, tuple[str, float]] = {
    "length": ("value_um", 1e-3),
    "position": ("value_um", 1e-3),
    "radial": ("value_um", 1e-3),
    "scale": ("value_ppm", 1e-6),
    "angle": ("value_mdeg", 1e-3 * math.pi / 180.0),
    "between-nodes": ("value_mdeg", 1e-3 * math.pi / 180.0),
    "direction": ("value_mrad", 1e-3),
    "links": ("value_ppm", 1e-6),
    "reflector": ("value_um", 1e-3),
}
"""Key that a kind's value stands under, and what makes mm, rad or a share of it."""

_DIVISORS: dict[str, float] = {
    "normal": 1.0,
    "uniform": math.sqrt(3.0),
    "triangular": math.sqrt(6.0),
    "arcsine": math.sqrt(2.0),
}
"""Standard uncertainty of a half width (GUM 4.3); a normal contributor is stated by its standard uncertainty."""

_TOTALS: dict[str, Any] = {
    "repeatability_um": 10.0,
    "laser_um": 0.22,
    "aim_um": 0.31,
    "radial_j1_um": 5.0,
    "radial_j2_um": 5.0,
    "radial_j4_um": 10.0,
    "radial_orders": 5,
}
"""Keys of the section before it was a list, with their defaults then."""

_ROUGHNESS_MDEG = 2.0
"""Rms of what a joint does between the nodes of its map: an assumption."""

_DRIFT_UM, _WARMTH_PPM = 2.0, 2.0
"""Rms over the measurement of what the zero drifts by and of what the links grow by: assumptions."""

_MOST_HARMONICS = 20

_TYPICAL_BEAM_MM = 743.3
"""Beam of the paper's example: from (100, 100) mm to the reflector at (650, -400) mm."""


def _usual_orders(given: dict[str, Any]) -> int:
    """Return how many orders a contributor has: metal warms slowly, air and clamps change within minutes."""
    if given.get("correlation") != "time":
        return 5
    return 3 if given.get("kind") == "links" else 31


class ContributorEntry(Section):
    """[[uncertainty.contributor]]: one line of the budget."""

    name: Annotated[str, StringConstraints(min_length=1, max_length=80)]
    kind: Kind
    value_um: NotNegative | None = None
    value_ppm: NotNegative | None = None
    value_mdeg: NotNegative | None = None
    value_mrad: NotNegative | None = None
    distribution: Distribution = "normal"
    correlation: Correlation = "reading"
    axis: Literal["j1", "j2", "j4"] | None = None
    orders: Annotated[int, Field(ge=1, le=255)] = Field(default_factory=_usual_orders)
    degrees_of_freedom: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    # Name of the run that measured the value; nobody has, where it is empty.
    measured_by: str = Field(default="", exclude_if=lambda run: not run)
    spectrum: tuple[NotNegative, ...] = Field(
        default=(), strict=False, exclude_if=lambda spectrum: not spectrum
    )

    @model_validator(mode="after")
    def _sound(self) -> Self:
        if self.correlation != "time" and self.orders > _MOST_HARMONICS:
            raise ValueError(f"{self.name}: an angle has up to {_MOST_HARMONICS} orders, not {self.orders}")
        wanted, _ = _UNITS[self.kind]
        keys = ("value_um", "value_ppm", "value_mdeg", "value_mrad")
        given = [key for key in keys if getattr(self, key) is not None]
        if given != [wanted]:
            raise ValueError(
                f"{self.name}: kind {self.kind} is stated by {wanted}, not by {', '.join(given) or 'nothing'}"
            )
        self.contributor()
        return self

    @property
    def stated(self) -> str:
        """Value with its unit, as the file states it."""
        key, _ = _UNITS[self.kind]
        return f"{getattr(self, key):g} {key.removeprefix('value_').replace('um', 'µm')}"

    @property
    def assumed(self) -> bool:
        """It stands in the default budget as it is: nobody has measured it on this bench."""
        return self.model_copy(update={"spectrum": ()}) in table_2()

    def contributor(self) -> Contributor:
        """Return the line with its standard uncertainty in mm, rad or as a share."""
        key, factor = _UNITS[self.kind]
        return Contributor(
            name=self.name,
            kind=self.kind,
            u=factor * float(getattr(self, key)) / _DIVISORS[self.distribution],
            correlation=self.correlation,
            axis=self.axis,
            distribution=self.distribution,
            orders=self.orders,
            dof=math.inf if self.degrees_of_freedom is None else self.degrees_of_freedom,
            spectrum=self.spectrum,
        )


WAVELENGTH: Final = "wavelength"
"""Name of the contributor that is the laser's own: it errs alike wherever the same laser measures."""

PAPER_WAVELENGTH_PPM: Final = 0.054
"""What the paper states for its own laser."""


def table_2(
    repeatability_um: float = 10.0,
    radial_um: tuple[float, float, float] = (5.0, 5.0, 10.0),
    radial_orders: int = 5,
    wavelength_ppm: float = 1e6 * HE_NE_RELATIVE_U,
) -> list[ContributorEntry]:
    """Return Table 2 of the SCARA paper.

    The table states micrometres in one distance of 743 mm. Wavelength and its correction are a scale that all
    distances share; the others are as they stand there. What lies between nodes and what changes with time is not in
    the table.

    Args:
        wavelength_ppm: of the laser; by default that of any helium-neon laser, whose wavelength is the default of
            [air].
    """
    return [
        ContributorEntry(name=WAVELENGTH, kind="scale", value_ppm=wavelength_ppm, correlation="common"),
        ContributorEntry(name="wavelength correction", kind="scale", value_ppm=0.256, correlation="common"),
        ContributorEntry(name="environmental change", kind="length", value_um=0.09),
        ContributorEntry(name="repeatability of the robot", kind="position", value_um=repeatability_um),
        *(
            ContributorEntry(
                name=f"radial error motion of {axis.upper()}",
                kind="radial",
                value_um=value,
                correlation="axis-angle",
                axis=axis,
                orders=radial_orders,
            )
            for axis, value in zip(_AXES, radial_um, strict=True)
        ),
        ContributorEntry(name="beam direction, J1", kind="direction", value_mrad=0.717),
        ContributorEntry(name="beam direction, J2", kind="direction", value_mrad=0.717),
        *(
            ContributorEntry(
                name=f"between the nodes of {axis.upper()}",
                kind="between-nodes",
                value_mdeg=_ROUGHNESS_MDEG,
                correlation="axis-angle",
                axis=axis,
            )
            for axis in _AXES[:2]
        ),
        ContributorEntry(
            name="drift of the zero", kind="length", value_um=_DRIFT_UM, correlation="time", orders=31
        ),
        ContributorEntry(
            name="warmth of the links", kind="links", value_ppm=_WARMTH_PPM, correlation="time", orders=3
        ),
    ]


_AXES: tuple[Literal["j1", "j2", "j4"], ...] = ("j1", "j2", "j4")


class Uncertainty(Section):
    """[uncertainty]: the error budget of a distance."""

    contributor: Annotated[list[ContributorEntry], Field(min_length=1)] = Field(default_factory=table_2)

    @model_validator(mode="before")
    @classmethod
    def _from_totals(cls, given: Any) -> Any:
        """Read the section of files and runs from before the list of contributors."""
        if not isinstance(given, dict) or not given or not set(given) <= set(_TOTALS):
            return given
        totals = _TOTALS | given
        radial = (totals["radial_j1_um"], totals["radial_j2_um"], totals["radial_j4_um"])
        lines = table_2(totals["repeatability_um"], radial, totals["radial_orders"])
        kept = [line for line in lines if line.kind == "radial" or line.name.startswith("repeatability")]
        laser = ContributorEntry(name="laser", kind="length", value_um=totals["laser_um"])
        beam = ContributorEntry(name="beam direction", kind="length", value_um=totals["aim_um"])
        return {"contributor": [*kept, laser, beam]}

    @model_validator(mode="after")
    def _names_of_their_own(self, info: ValidationInfo) -> Self:
        # Runs were made with names that occur twice; without their budget they can be identified all the same.
        if info.context is not RECORD:
            _ = self.budget
        return self

    @property
    def budget(self) -> Budget:
        """All contributors."""
        return Budget(tuple(entry.contributor() for entry in self.contributor))

    @property
    def white_um(self) -> float:
        """Standard uncertainty of what differs from distance to distance, on a beam of 0.74 m, µm."""
        return math.hypot(*(_typical_um(one) for one in self.budget.white))

    @property
    def distance_um(self) -> float:
        """Standard uncertainty of a single distance of 0.74 m, everything included but what is assumed, µm."""
        return math.hypot(*(_typical_um(one) for one in self.budget.contributors if not one.assumed))

    def radial_um(self, axis: Literal["j1", "j2", "j4"]) -> float:
        """Return the radial error motion of an axis, µm."""
        return 1e3 * math.hypot(*(one.u for one in self._radial if one.axis == axis))

    @property
    def radial_orders(self) -> int:
        """Harmonics that the radial error motions are taken to have."""
        return max((one.orders for one in self._radial), default=5)

    @property
    def _radial(self) -> tuple[Contributor, ...]:
        return tuple(one for one in self.budget.contributors if one.kind == "radial")


def _typical_um(one: Contributor) -> float:
    """Return what a contributor does to a distance of the typical beam, µm."""
    match one.kind:
        case "scale":
            return 1e3 * one.u * _TYPICAL_BEAM_MM
        case "angle":
            # The arm's reach is about half of the beam of the example.
            return 1e3 * one.u * 0.5 * _TYPICAL_BEAM_MM
        case "direction":
            return 1e3 * _TYPICAL_BEAM_MM * one.u**2 / math.sqrt(2.0)
        case _:
            return 1e3 * one.u
