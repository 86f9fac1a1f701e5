"""Residuals against each joint angle: is there a pattern along J1, J2 or J4 that the model leaves?"""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.projection import addition
from catseye.calibration.core.significance import Judged, adjusted
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.diagnostics.projection import DistanceProjection, angles_rad, mounts_rad
from catseye.calibration.scara.extension import Source

_MOST_LEVELS = 40
_BIN_RAD = np.deg2rad(10.0)


@dataclass(frozen=True)
class AnglePattern(Judged):
    """Mean residuals over the levels of one joint's angle, with a test whether they differ.

    Attributes:
        joint: 1, 2, or 4.
        angle_deg: mean angle of each level, °.
        mean_um: mean residual of each level (predicted minus measured), less what shared errors explain, µm; along J4
            of the first mounting: turned by half a turn, the interferometer sees the other side of what J4's axis
            does.
        count: distances of each level.
        explained_um: standard deviation of a distance that levels of their own would explain, µm.
        ratio: F; None when the model absorbs a level of its own for each angle.
        probability: of a ratio this large when there is nothing but the stated errors, corrected for the joints.
    """

    joint: int
    angle_deg: Floats
    mean_um: Floats
    count: Ints
    explained_um: float
    ratio: float | None
    probability: float


def angle_patterns(
    projection: DistanceProjection, nominal_mm: tuple[float, float], reflectors_mm: Floats
) -> list[AnglePattern]:
    """Return the residuals against θ1, θ2 and θ4.

    Args:
        projection: the fit, on the space that its model cannot reach.
        nominal_mm: nominal links, mm.
        reflectors_mm: places that the beam was aimed at, mm, shape (reflectors, 2).
    """
    angles = angles_rad(projection.points, nominal_mm, reflectors_mm)
    joints: dict[int, Source] = {1: "theta1", 2: "theta2", 4: "theta4"}
    seen = {4: np.cos(mounts_rad(projection.points))}
    whole = np.ones(len(projection.points))
    return [
        _pattern(projection, joint, angles[source], seen.get(joint, whole))
        for joint, source in joints.items()
    ]


def _pattern(projection: DistanceProjection, joint: int, angle_rad: Floats, share: Floats) -> AnglePattern:
    level = levels(angle_rad)
    count = np.bincount(level)
    member = np.zeros((angle_rad.size, count.size))
    member[np.arange(angle_rad.size), level] = share
    residual_um = 1e3 * share * projection.pulls / projection.weights
    found = addition(projection, member)
    return AnglePattern(
        joint=joint,
        angle_deg=np.rad2deg(np.bincount(level, angle_rad) / count),
        mean_um=np.bincount(level, residual_um) / count,
        count=count.astype(np.int64),
        explained_um=0.0 if found is None else found.explained_um,
        ratio=None if found is None else found.ratio,
        # Three joints are looked at.
        probability=1.0 if found is None else adjusted(found.probability, 3),
    )


def levels(angle_rad: Floats) -> Ints:
    """Return the number of each row's level: its angle, or its bin of 10° where angles are many, shape (n,)."""
    distinct, number = np.unique(np.round(angle_rad, 6), return_inverse=True)
    if distinct.size > _MOST_LEVELS:
        number = np.unique(np.floor(angle_rad / _BIN_RAD), return_inverse=True)[1]
    return np.asarray(np.ravel(number), dtype=np.int64)
