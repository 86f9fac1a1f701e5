"""Interferometer optics on an arm: from the measured length to angle or displacement, and how good they are.

Source: the resolution paper (A motion resolution-based engineering method …), section 2.2.
"""

from dataclasses import dataclass, replace
from typing import Final, Protocol

import numpy as np
from numpy.typing import ArrayLike

from catseye.calibration.core.arguments import require_not_negative, require_positive
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import RecordingError

_URAD = 1e-6
_METRE_MM = 1e3
_UM_MM = 1e-3
_MAKERS_K = 2.0
"""A maker's accuracy is read as an expanded uncertainty (ADR 34)."""

_RMS_OF_SQUARE = 0.5 * 3.0**0.5
"""Of ε² / 2, relative to the variance of a normal ε."""

U_ZERO_DEG: Final = 1.0
"""How well optics that were aligned by their signal are known to be parallel, k = 1: an assumption."""


class Optics(Protocol):
    """What steps need to know of the optics that measured them, in the unit of the steps."""

    @property
    def u_scale(self) -> float:
        """Relative standard uncertainty that all steps of a recording share."""

    def u_step(self, step: ArrayLike) -> Floats:
        """Return the standard uncertainty of a step by the optics alone."""


@dataclass(frozen=True)
class AngularOptics:
    """Angular optics: two retroreflectors side by side turn a rotation into a difference of two paths.

    The accuracy is the maker's: ± (constant + share · Δθ + per metre · M), Δθ being the angle between two readings.

    Attributes:
        spacing_mm: S, distance of the two reflectors, mm.
        u_spacing_mm: its standard uncertainty, mm; the share contains what the maker knows of it.
        distance_m: M, from interferometer to reflector, m.
        accuracy_urad: constant part, µrad.
        accuracy_share: share of the angle.
        accuracy_urad_per_m: part that grows with the distance, µrad/m.
        coverage_factor: k of the accuracy.
        zero_rad: θ0, angle of the optics from parallel where the displacement is 0, rad.
        u_zero_rad: its standard uncertainty, rad.
        turned_rad: largest angle from parallel of the steps that are judged, rad; see `over`.
    """

    spacing_mm: float
    u_spacing_mm: float = 0.0
    distance_m: float = 0.5
    accuracy_urad: float = 0.5
    accuracy_share: float = 0.002
    accuracy_urad_per_m: float = 0.1
    coverage_factor: float = _MAKERS_K
    zero_rad: float = 0.0
    u_zero_rad: float = 0.0
    turned_rad: float = 0.0

    def __post_init__(self) -> None:
        require_positive(self.spacing_mm, "spacing_mm")
        require_positive(self.coverage_factor, "coverage_factor")
        rest = [self.u_spacing_mm, self.distance_m, self.accuracy_urad, self.accuracy_share]
        require_not_negative([*rest, self.accuracy_urad_per_m], "u_spacing_mm, distance_m, accuracy")
        require_not_negative([self.u_zero_rad, self.turned_rad], "u_zero_rad, turned_rad")

    def angle_rad(self, displacement_mm: Floats) -> Floats:
        """Return θ = arcsin(ΔL / S + sin θ0), never its small-angle form, rad from parallel, shape (n,).

        Args:
            displacement_mm: ΔL since the optics stood at θ0, mm, shape (n,).

        Raises:
            RecordingError: a displacement is no sine of an angle.
        """
        sine = displacement_mm / self.spacing_mm + np.sin(self.zero_rad)
        beyond = np.flatnonzero(np.abs(sine) > 1.0)
        if beyond.size:
            row = int(beyond[0])
            since = f", from {np.degrees(self.zero_rad):g}° on," if self.zero_rad else ""
            raise RecordingError(
                f"sample {row + 1}: a displacement of {displacement_mm[row]:g} mm{since} exceeds the spacing S = "
                f"{self.spacing_mm:g} mm of the optics, so it is not the sine of an angle: check spacing and unit, "
                "whether the column holds angles, and whether the columns are swapped",
                row + 1,
            )
        return np.asarray(np.arcsin(sine), dtype=np.float64)

    def over(self, angle_rad: Floats) -> "AngularOptics":
        """Return them for steps at angles from parallel, rad, shape (n,): u of the zero grows with these."""
        return replace(self, turned_rad=float(np.abs(angle_rad).max(initial=0.0)))

    @property
    def u_zero_share(self) -> float:
        """Relative standard uncertainty of a step since nobody knows where the optics are parallel.

        Where they really stand at θ + ε, a step seems 1 / cos θ · cos(θ + ε) times what it is: 1 − ε tan θ − ε² / 2.
        """
        return float(np.hypot(np.tan(self.turned_rad) * self.u_zero_rad, _RMS_OF_SQUARE * self.u_zero_rad**2))

    @property
    def u_scale(self) -> float:
        """Relative standard uncertainty that all angles of a recording share."""
        return float(np.hypot(self.accuracy_share / self.coverage_factor, self._u_geometry))

    @property
    def _u_geometry(self) -> float:
        """Relative standard uncertainty by spacing and zero."""
        # dθ = −tan θ · dS / S; between two readings near θ that is 1 / cos² θ times the step, 1.008 at 5°.
        return float(np.hypot(self.u_spacing_mm / self.spacing_mm, self.u_zero_share))

    def u_step(self, step: ArrayLike) -> Floats:
        """Return the standard uncertainty of an angle between two readings by the optics alone, rad.

        Args:
            step: the angle between them, rad, any shape.
        """
        constant = (self.accuracy_urad + self.accuracy_urad_per_m * self.distance_m) * _URAD
        size = np.abs(np.asarray(step, dtype=np.float64))
        makers = (constant + self.accuracy_share * size) / self.coverage_factor
        return np.hypot(makers, size * self._u_geometry)


@dataclass(frozen=True)
class AngleAccuracy:
    """An instrument that gives angles itself, ± (constant + share · Δθ) between two readings.

    Attributes:
        constant_urad: constant part, µrad.
        share: of the angle.
        coverage_factor: k of the accuracy.
    """

    constant_urad: float = 0.0
    share: float = 0.0
    coverage_factor: float = _MAKERS_K

    def __post_init__(self) -> None:
        require_positive(self.coverage_factor, "coverage_factor")
        require_not_negative([self.constant_urad, self.share], "constant_urad, share")

    @property
    def u_scale(self) -> float:
        """Relative standard uncertainty that all angles of a recording share."""
        return self.share / self.coverage_factor

    def u_step(self, step: ArrayLike) -> Floats:
        """Return the standard uncertainty of an angle between two readings, rad, any shape."""
        size = np.abs(np.asarray(step, dtype=np.float64))
        return np.asarray((self.constant_urad * _URAD + self.share * size) / self.coverage_factor)


@dataclass(frozen=True)
class LinearOptics:
    """Linear optics: the displacement itself, ± accuracy · Δd.

    Attributes:
        accuracy_um_per_m: accuracy over the displacement, µm/m.
        coverage_factor: k of the accuracy.
    """

    accuracy_um_per_m: float = 0.5
    coverage_factor: float = _MAKERS_K

    def __post_init__(self) -> None:
        require_not_negative(self.accuracy_um_per_m, "accuracy_um_per_m")
        require_positive(self.coverage_factor, "coverage_factor")

    @property
    def u_scale(self) -> float:
        """Relative standard uncertainty that all displacements of a recording share."""
        return self.accuracy_um_per_m * _UM_MM / _METRE_MM / self.coverage_factor

    def u_step(self, step: ArrayLike) -> Floats:
        """Return the standard uncertainty of a displacement between two readings by the optics alone, mm."""
        return np.abs(np.asarray(step, dtype=np.float64)) * self.u_scale
