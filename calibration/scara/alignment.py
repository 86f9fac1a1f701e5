"""How the beam lies to the arm: its offset from the J4 axis and its pitch (Remark 2).

In the frame of the beam x runs along it and y to its left, seen from above. The beam passes the J4 axis at an offset
e, positive towards +y. With the beam on the centre of a reflector at distance D, J4 is turned by a small φ; then the
length is L(φ) = D cos φ + e sin φ, so its slope at φ = 0 is e and its curvature −D. Upwards the beam rises by its
pitch ε, so the height of J3 at which it meets a reflector's centre is z(D) = z0 − ε D.
"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_finite, require_not_negative, require_shape
from catseye.calibration.core.errors import InsufficientPointsError, UnidentifiableError
from catseye.calibration.core.types import Floats, Ints


@dataclass(frozen=True)
class OffsetFit:
    """The beam's offset from the J4 axis.

    Attributes:
        offset_mm: e, positive where the beam passes the axis on its left; mm, and mm/rad of length.
        u_mm: standard uncertainty, from the scatter about the fit or the stated noise, whichever is larger.
        curvature_mm: factor of φ² in the fit, mm/rad²; half the distance, negative.
        u_curvature_mm: its standard uncertainty, mm/rad².
        rms_mm: scatter about the fit.
    """

    offset_mm: float
    u_mm: float
    curvature_mm: float
    u_curvature_mm: float
    rms_mm: float

    def plausible_at(self, distance_mm: float, rough_mm: float) -> bool:
        """Return whether the curvature is that of a beam of this length turned about J4 alone.

        Args:
            distance_mm: from the J4 axis to the reflector.
            rough_mm: what that distance may be wrong by.
        """
        return abs(self.curvature_mm + 0.5 * distance_mm) <= 0.5 * rough_mm + 4.0 * self.u_curvature_mm


def fit_offset(turn_rad: Floats, length_mm: Floats, series: Ints, u_length_mm: float) -> OffsetFit:
    """Fit L(φ) = c0 + c1 φ + c2 φ² with a c0 of its own for each series.

    Args:
        turn_rad: J4 from where the beam meets the reflector's centre, rad, shape (n,).
        length_mm: lengths or displacements, mm, shape (n,).
        series: number of the pass up or down that each belongs to, from 0, shape (n,).
        u_length_mm: stated standard uncertainty of a length against the others.

    Raises:
        InsufficientPointsError: no more lengths than unknowns.
        UnidentifiableError: the turns do not separate slope and curvature.
        ArgumentError: the columns do not fit together, a number is not finite, or the uncertainty is negative.
    """
    _require_columns(turn_rad, length_mm, u_length_mm)
    require_shape(series, turn_rad.shape, "series")
    passes = np.unique(series)
    unknowns = passes.size + 2
    if turn_rad.size <= unknowns:
        raise InsufficientPointsError(
            f"{turn_rad.size} lengths cannot determine {unknowns} unknowns: measure at more angles of J4"
        )
    span = float(np.max(np.abs(turn_rad)))
    if span == 0.0:
        raise UnidentifiableError("J4 was not turned: measure at several angles", [["offset"]])
    part = turn_rad / span
    design = np.column_stack([*(series == number for number in passes), part, part**2]).astype(np.float64)
    values, covariance, rms_mm = _least_squares(design, length_mm, u_length_mm)
    u = np.sqrt(np.diag(covariance))
    return OffsetFit(
        offset_mm=float(values[-2] / span),
        u_mm=float(u[-2] / span),
        curvature_mm=float(values[-1] / span**2),
        u_curvature_mm=float(u[-1] / span**2),
        rms_mm=rms_mm,
    )


@dataclass(frozen=True)
class PitchFit:
    """The beam's angle with the XY plane, and the heights of J3 at which it meets the reflector.

    Attributes:
        pitch_rad: ε, positive where the beam rises.
        u_pitch_rad: standard uncertainty.
        axis_height_mm: z0, the height at distance 0.
        covariance: of (z0, −ε), mm², mm rad, rad², shape (2, 2).
        rms_mm: scatter about the line.
    """

    pitch_rad: float
    u_pitch_rad: float
    axis_height_mm: float
    covariance: Floats
    rms_mm: float

    def height_mm(self, distance_mm: float) -> float:
        """Return the height of J3 at which the beam meets the reflector's centre from a distance, mm."""
        return self.axis_height_mm - self.pitch_rad * distance_mm

    def u_height_mm(self, distance_mm: float) -> float:
        """Return the standard uncertainty of that height, mm."""
        gradient = np.array([1.0, distance_mm])
        return float(np.sqrt(gradient @ self.covariance @ gradient))


def fit_pitch(distance_mm: Floats, height_mm: Floats, u_height_mm: float) -> PitchFit:
    """Fit z(D) = z0 − ε D.

    Args:
        distance_mm: from the J4 axis to the reflector, mm, shape (n,).
        height_mm: J3 in the middle of the return, mm, shape (n,).
        u_height_mm: stated standard uncertainty of such a height; two distances have no scatter of their own.

    Raises:
        InsufficientPointsError: fewer than two heights.
        UnidentifiableError: all distances are the same.
        ArgumentError: the columns do not fit together, a number is not finite, or the uncertainty is negative.
    """
    _require_columns(distance_mm, height_mm, u_height_mm)
    if distance_mm.size < 2:
        raise InsufficientPointsError(
            f"the pitch needs heights at two distances or more, not {distance_mm.size}: measure at more poses"
        )
    if np.ptp(distance_mm) <= 0.0:
        raise UnidentifiableError(
            "all distances are the same: measure at poses nearer and farther", [["pitch"]]
        )
    design = np.column_stack([np.ones(distance_mm.size), distance_mm])
    values, covariance, rms_mm = _least_squares(design, height_mm, u_height_mm)
    return PitchFit(
        pitch_rad=float(-values[1]),
        u_pitch_rad=float(np.sqrt(covariance[1, 1])),
        axis_height_mm=float(values[0]),
        covariance=covariance,
        rms_mm=rms_mm,
    )


def _require_columns(given: Floats, observed: Floats, u: float) -> None:
    require_shape(observed, given.shape, "what was measured")
    require_finite(given, "where it was measured")
    require_finite(observed, "what was measured")
    require_not_negative(u, "its standard uncertainty")


def _least_squares(design: Floats, observed: Floats, u_stated: float) -> tuple[Floats, Floats, float]:
    """Return the solution, its covariance and the rms residual; the larger of scatter and stated noise counts."""
    scale = np.sqrt(np.sum(design**2, axis=0))
    inverse = np.linalg.pinv(design / scale) / scale[:, None]
    values = inverse @ observed
    residuals = observed - design @ values
    square = float(residuals @ residuals)
    dof = observed.size - design.shape[1]
    variance = max(square / dof if dof else 0.0, u_stated**2)
    return values, variance * (inverse @ inverse.T), float(np.sqrt(square / observed.size))
