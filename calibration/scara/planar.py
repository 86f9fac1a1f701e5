"""Planar kinematics of a SCARA arm: joints J1 and J2, links L1 and L2.

The origin is the J1 axis; angles count counter-clockwise from +X (Eq. 3 of the SCARA paper).
"""

from typing import Literal

import numpy as np

from catseye.calibration.core.arguments import require_one_of, require_positive
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.errors import OutOfReachError

Hand = Literal["right", "left"]


def forward(
    theta1_rad: Floats, theta2_rad: Floats, link1_mm: Floats | float, link2_mm: Floats | float
) -> Floats:
    """Return the positions of the J4 axis.

    Args:
        theta1_rad: J1 angles, rad, any shape.
        theta2_rad: J2 angles, rad, same shape.
        link1_mm: length of link 1, mm, one for all or of the angles' shape.
        link2_mm: length of link 2, mm, likewise.

    Returns:
        x and y in mm on a new last axis, shape (..., 2).
    """
    first = np.asarray(theta1_rad, dtype=np.float64)
    both = first + theta2_rad
    x_mm = link1_mm * np.cos(first) + link2_mm * np.cos(both)
    y_mm = link1_mm * np.sin(first) + link2_mm * np.sin(both)
    position_mm = np.empty((*np.shape(x_mm), 2))
    position_mm[..., 0], position_mm[..., 1] = x_mm, y_mm
    return position_mm


def inverse(
    xy_mm: Floats, link1_mm: Floats | float, link2_mm: Floats | float, hand: Hand = "right"
) -> tuple[Floats, Floats]:
    """Return the joint angles that bring the J4 axis to the given positions.

    Args:
        xy_mm: positions, mm, shape (..., 2).
        link1_mm: length of link 1, mm, one for all or shape (...).
        link2_mm: length of link 2, mm, likewise.
        hand: "right" has theta2 >= 0, "left" has theta2 <= 0.

    Returns:
        theta1 and theta2, rad, each of shape (...); theta1 lies in (-pi, pi].

    Raises:
        OutOfReachError: a position lies outside the ring that the arm reaches; names the first one.
        ArgumentError: the hand is unknown, or a link is not positive.
    """
    require_one_of(Hand, hand, "hand")
    require_links(link1_mm, link2_mm)
    x_mm, y_mm = np.moveaxis(np.asarray(xy_mm, dtype=np.float64), -1, 0)
    cosine = (x_mm**2 + y_mm**2 - link1_mm**2 - link2_mm**2) / (2.0 * link1_mm * link2_mm)
    _require_reach(cosine, x_mm, y_mm, link1_mm, link2_mm)
    theta2 = np.arccos(np.clip(cosine, -1.0, 1.0))
    if hand == "left":
        theta2 = -theta2
    elbow_x = link1_mm + link2_mm * np.cos(theta2)
    theta1 = np.arctan2(y_mm, x_mm) - np.arctan2(link2_mm * np.sin(theta2), elbow_x)
    return wrap_rad(theta1), theta2


def position_jacobian(
    theta1_rad: Floats, theta2_rad: Floats, link1_mm: Floats | float, link2_mm: Floats | float
) -> Floats:
    """Return the derivatives of the position.

    Args:
        theta1_rad: J1 angles, rad, shape (n,).
        theta2_rad: J2 angles, rad, shape (n,).
        link1_mm: length of link 1, mm, one for all or shape (n,).
        link2_mm: length of link 2, mm, likewise.

    Returns:
        d(x, y) / d(L1, L2, theta1, theta2), shape (n, 2, 4), mm/mm and mm/rad.
    """
    both = theta1_rad + theta2_rad
    cos1, sin1, cos12, sin12 = np.cos(theta1_rad), np.sin(theta1_rad), np.cos(both), np.sin(both)
    d_theta2_x, d_theta2_y = -link2_mm * sin12, link2_mm * cos12
    d_theta1_x, d_theta1_y = d_theta2_x - link1_mm * sin1, d_theta2_y + link1_mm * cos1
    row_x = np.stack([cos1, cos12, d_theta1_x, d_theta2_x], axis=-1)
    row_y = np.stack([sin1, sin12, d_theta1_y, d_theta2_y], axis=-1)
    return np.stack([row_x, row_y], axis=-2)


def require_links(link1_mm: Floats | float, link2_mm: Floats | float) -> None:
    """Refuse lengths of links that are not positive."""
    require_positive(link1_mm, "link1_mm")
    require_positive(link2_mm, "link2_mm")


def wrap_rad(angle_rad: Floats) -> Floats:
    """Return angles brought to (-pi, pi], rad, same shape."""
    wrapped: Floats = np.pi - np.mod(np.pi - np.asarray(angle_rad, dtype=np.float64), 2.0 * np.pi)
    return wrapped


def _require_reach(
    cosine: Floats, x_mm: Floats, y_mm: Floats, link1_mm: Floats | float, link2_mm: Floats | float
) -> None:
    # A pose at full stretch may exceed 1 by rounding; a nanometre of reach is the tolerance.
    outside = np.flatnonzero(np.ravel(~(np.abs(cosine) <= 1.0 + 1e-9)))
    if outside.size:
        first = int(outside[0])
        one, two = (np.ravel(np.broadcast_to(link, cosine.shape))[first] for link in (link1_mm, link2_mm))
        raise OutOfReachError(
            f"position {first + 1} of {cosine.size} (x = {np.ravel(x_mm)[first]:g} mm, "
            f"y = {np.ravel(y_mm)[first]:g} mm) is out of reach: the arm covers radii from "
            f"{abs(one - two):g} to {one + two:g} mm"
        )
