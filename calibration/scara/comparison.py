"""A model against an independent measurement: rigid alignment, deviations, figures."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_finite, require_shape
from catseye.calibration.core.errors import InsufficientPointsError, UnidentifiableError
from catseye.calibration.core.types import Bools, Floats

_ONE_PLACE_MM = 1e-6
"""Positions that differ by less have no orientation."""


@dataclass(frozen=True)
class RigidTransform:
    """Rotation about the origin, then shift, in the plane.

    Attributes:
        rotation_rad: counter-clockwise angle, rad.
        shift_mm: x and y, mm, shape (2,).
    """

    rotation_rad: float
    shift_mm: Floats

    def apply(self, xy_mm: Floats) -> Floats:
        """Return transformed positions, mm, shape (n, 2)."""
        cosine, sine = np.cos(self.rotation_rad), np.sin(self.rotation_rad)
        turned = xy_mm @ np.array([[cosine, sine], [-sine, cosine]])
        return np.asarray(turned + self.shift_mm, dtype=np.float64)

    def undo(self, xy_mm: Floats) -> Floats:
        """Return the positions that this transform brings to given ones, mm, shape (n, 2)."""
        return RigidTransform(-self.rotation_rad, np.zeros(2)).apply(xy_mm - self.shift_mm)


def rigid_fit(source_mm: Floats, target_mm: Floats) -> RigidTransform:
    """Return the rotation and shift that bring source onto target in the least-squares sense.

    Args:
        source_mm: positions, mm, shape (n, 2), n >= 2 and not all in one place.
        target_mm: the same positions in the other frame, mm, shape (n, 2).

    Raises:
        InsufficientPointsError: fewer than two positions.
        UnidentifiableError: they all lie in one place.
    """
    if source_mm.shape[0] < 2:
        raise InsufficientPointsError(
            "a rigid alignment needs at least two positions inside the identified range"
        )
    source_mean, target_mean = source_mm.mean(axis=0), target_mm.mean(axis=0)
    a, b = source_mm - source_mean, target_mm - target_mean
    if not np.any(np.abs(a) > _ONE_PLACE_MM):
        raise UnidentifiableError(
            "all positions lie in one place, so the rotation of the frames is not determined: compare positions "
            "that are spread out",
            [["rotation"]],
        )
    rotation = float(np.arctan2(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), np.sum(a * b)))
    turned = RigidTransform(rotation, np.zeros(2)).apply(source_mean[None, :])[0]
    return RigidTransform(rotation, target_mean - turned)


@dataclass(frozen=True)
class Comparison:
    """A model's prediction against a measurement, after rigid alignment of the measurement.

    Attributes:
        transform: brings the measurement into the frame of the model.
        aligned_mm: measured positions in that frame, shape (n, 2).
        measured_error_mm: measured minus command position in that frame, shape (n, 2).
        difference_mm: measured minus predicted, shape (n, 2); NaN outside the identified range.
        inside: rows that were compared, shape (n,).
    """

    transform: RigidTransform
    aligned_mm: Floats
    measured_error_mm: Floats
    difference_mm: Floats
    inside: Bools

    @property
    def rms_um(self) -> tuple[float, float]:
        """Rms of the difference in x and y, µm."""
        square = np.mean(self.difference_mm[self.inside] ** 2, axis=0)
        return 1e3 * float(np.sqrt(square[0])), 1e3 * float(np.sqrt(square[1]))

    @property
    def rms_2d_um(self) -> float:
        """Rms of the length of the difference, µm."""
        return float(np.hypot(*self.rms_um))

    @property
    def max_um(self) -> float:
        """Largest length of the difference, µm."""
        return 1e3 * float(np.hypot(*self.difference_mm[self.inside].T).max())

    @property
    def worst(self) -> int:
        """Row of the largest difference."""
        return int(np.nanargmax(np.hypot(*self.difference_mm.T)))


def compare(command_mm: Floats, predicted_mm: Floats, measured_mm: Floats, inside: Bools) -> Comparison:
    """Compare predicted with measured positions.

    Distances cannot fix the rotation about J1, and an independent instrument has a frame of its own: the
    measured positions are brought onto the predicted ones by a rigid fit first.

    Args:
        command_mm: command positions, mm, shape (n, 2).
        predicted_mm: the model's positions, mm, shape (n, 2).
        measured_mm: measured positions in the instrument's frame, mm, shape (n, 2).
        inside: rows to compare, shape (n,).

    Raises:
        InsufficientPointsError: fewer than two rows to compare.
        ArgumentError: the columns do not fit together, or a position to compare is not finite.
    """
    for name, column in (
        ("command_mm", command_mm),
        ("predicted_mm", predicted_mm),
        ("measured_mm", measured_mm),
    ):
        require_shape(column, (inside.size, 2), name)
        require_finite(column[inside], name)
    transform = rigid_fit(measured_mm[inside], predicted_mm[inside])
    aligned = transform.apply(measured_mm)
    difference = np.where(inside[:, None], aligned - predicted_mm, np.nan)
    return Comparison(transform, aligned, aligned - command_mm, difference, inside)
