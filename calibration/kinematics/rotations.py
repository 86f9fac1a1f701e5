"""Rotations and poses: R = Rz·Ry·Rx of three angles, as files and KUKA's A, B, C have them, and rotation vectors."""

import numpy as np

from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.types import Floats

_LOCK = 1e-9
"""Cosine of the second angle below which the first and the third turn about the same axis."""

_SKEW = 1e-6
"""How far axes of a rotation that files have rounded may be from unit length and right angles."""


def rotation_of(angles_deg: Floats) -> Floats:
    """Return rotations from their angles.

    Args:
        angles_deg: about x, y and z of the fixed frame, in this order, shape (..., 3).

    Returns:
        R = Rz·Ry·Rx, shape (..., 3, 3).
    """
    angles = np.deg2rad(angles_deg)
    cosines, sines = np.cos(angles), np.sin(angles)
    cx, cy, cz = cosines[..., 0], cosines[..., 1], cosines[..., 2]
    sx, sy, sz = sines[..., 0], sines[..., 1], sines[..., 2]
    # Filled in place: of single rotations stacking took most of the time.
    found = np.empty((*angles.shape, 3))
    found[..., 0, 0], found[..., 0, 1], found[..., 0, 2] = (
        cz * cy,
        cz * sy * sx - sz * cx,
        cz * sy * cx + sz * sx,
    )
    found[..., 1, 0], found[..., 1, 1], found[..., 1, 2] = (
        sz * cy,
        sz * sy * sx + cz * cx,
        sz * sy * cx - cz * sx,
    )
    found[..., 2, 0], found[..., 2, 1], found[..., 2, 2] = -sy, cy * sx, cy * cx
    return found


def angles_of(rotation: Floats) -> Floats:
    """Return the angles of rotations R = Rz·Ry·Rx.

    Where the second angle is ±90° only a sum of the others is determined; the third is 0 there.

    Args:
        rotation: shape (..., 3, 3).

    Returns:
        Angles about x, y, z, deg, the second within ±90, shape (..., 3).
    """
    cosine = np.hypot(rotation[..., 0, 0], rotation[..., 1, 0])
    locked = cosine < _LOCK
    ry = np.arctan2(-rotation[..., 2, 0], cosine)
    rz = np.where(locked, 0.0, np.arctan2(rotation[..., 1, 0], rotation[..., 0, 0]))
    free, held = (rotation[..., 2, 1], rotation[..., 2, 2]), (-rotation[..., 1, 2], rotation[..., 1, 1])
    rx = np.where(locked, np.arctan2(*held), np.arctan2(*free))
    found: Floats = np.rad2deg(np.stack([rx, ry, rz], axis=-1))
    return found


def rotation_vectors_deg(rotation: Floats) -> Floats:
    """Return rotations as axis times angle.

    By way of the quaternion's largest component (Shepperd 1978), which holds up to half a turn.

    Args:
        rotation: shape (n, 3, 3).

    Returns:
        deg, at most 180 long, shape (n, 3).
    """
    trace = np.trace(rotation, axis1=-2, axis2=-1)
    diagonal = np.diagonal(rotation, axis1=-2, axis2=-1)
    across = np.stack([rotation[:, k - 1, k - 2] - rotation[:, k - 2, k - 1] for k in range(3)], axis=-1)
    # Four times the products of the quaternion (w, x, y, z) with itself; its row of the largest square is the best.
    products = np.empty((len(rotation), 4, 4))
    products[:, 1:, 1:] = rotation + rotation.transpose(0, 2, 1)
    products[:, 0, 0] = 1.0 + trace
    products[:, 0, 1:] = products[:, 1:, 0] = across
    for k in range(3):
        products[:, k + 1, k + 1] = 1.0 - trace + 2.0 * diagonal[:, k]
    best = np.argmax(np.diagonal(products, axis1=-2, axis2=-1), axis=-1)
    quaternion = products[np.arange(len(rotation)), best]
    quaternion = quaternion * np.where(quaternion[:, :1] < 0.0, -1.0, 1.0)
    length = np.linalg.norm(quaternion[:, 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(length, quaternion[:, :1])
    # Of the shortest vectors angle / length is 2 / w, and w is the largest component there.
    per_length = np.divide(angle, length, out=2.0 / np.maximum(quaternion[:, :1], 0.5), where=length > 1e-150)
    found: Floats = np.rad2deg(per_length * quaternion[:, 1:])
    return found


def pose_of(position_mm: Floats, angles_deg: Floats) -> Floats:
    """Return homogeneous transforms.

    Args:
        position_mm: shape (..., 3).
        angles_deg: about x, y, z, as `rotation_of` takes them, shape (..., 3).

    Returns:
        Lengths in mm, shape (..., 4, 4).
    """
    made = np.zeros((*np.broadcast_shapes(np.shape(position_mm), np.shape(angles_deg))[:-1], 4, 4))
    made[..., :3, :3] = rotation_of(np.asarray(angles_deg, dtype=np.float64))
    made[..., :3, 3] = position_mm
    made[..., 3, 3] = 1.0
    return made


def inverted(pose: Floats) -> Floats:
    """Return the inverses of homogeneous transforms, shape (..., 4, 4)."""
    made = np.zeros_like(pose)
    back = np.swapaxes(pose[..., :3, :3], -1, -2)
    made[..., :3, :3] = back
    made[..., :3, 3] = -np.einsum("...ij,...j->...i", back, pose[..., :3, 3])
    made[..., 3, 3] = 1.0
    return made


def require_poses(poses: Floats, what: str) -> None:
    """Refuse arrays that are no rigid transforms.

    Args:
        poses: shape (n, 4, 4).
        what: as messages call them.

    Raises:
        KinematicsError: the shape is another, or a row is not finite or no rigid transform.
    """
    if poses.ndim != 3 or poses.shape[1:] != (4, 4):
        raise KinematicsError(
            f"{what}: shape {poses.shape} instead of (n, 4, 4): give homogeneous transforms"
        )
    x, y, z = poses[:, :3, :3].transpose(2, 1, 0)
    with np.errstate(invalid="ignore", over="ignore"):
        # Of a right-handed rotation the third axis is the product of the others; lengths and angle follow.
        odd = np.abs(
            np.stack([y[2] * x[1] - y[1] * x[2], y[0] * x[2] - y[2] * x[0], y[1] * x[0] - y[0] * x[1]]) - z
        )
        odd = np.maximum(odd.max(axis=0, initial=0.0), np.abs(np.einsum("in,in->n", x, y)))
        odd = np.maximum(odd, np.abs(np.einsum("in,in->n", x, x) - 1.0))
        odd = np.maximum(odd, np.abs(np.einsum("in,in->n", z, z) - 1.0))
        sound = (odd <= _SKEW) & np.isfinite(poses[:, :3, 3]).all(axis=1)
    sound &= (poses[:, 3] == [0.0, 0.0, 0.0, 1.0]).all(axis=1)
    if not sound.all():
        raise KinematicsError(
            f"{what}: row {int(np.argmin(sound))} is not a rigid transform: its rotation has to be orthonormal and "
            "right-handed, all its numbers finite"
        )
