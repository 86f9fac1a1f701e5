"""Frames as homogeneous transforms, mm, from places and angles."""

import numpy as np

from catseye.simulators.world.types import Floats


def frames_of(places_mm: Floats, angles_rad: Floats) -> Floats:
    """Return frames at places, turned about x, then y, then z of what they stand in: R = Rz·Ry·Rx.

    Args:
        places_mm: shape (..., 3).
        angles_rad: about x, y and z, shape (..., 3).

    Returns:
        Shape (..., 4, 4).
    """
    found = np.zeros((*places_mm.shape[:-1], 4, 4))
    found[..., :3, :3] = _about(2, angles_rad) @ _about(1, angles_rad) @ _about(0, angles_rad)
    found[..., :3, 3] = places_mm
    found[..., 3, 3] = 1.0
    return found


def inverse(frames: Floats) -> Floats:
    """Return the inverse transforms, same shape (..., 4, 4)."""
    found = np.zeros_like(frames)
    turned = np.swapaxes(frames[..., :3, :3], -1, -2)
    found[..., :3, :3] = turned
    found[..., :3, 3] = -(turned @ frames[..., :3, 3:])[..., 0]
    found[..., 3, 3] = 1.0
    return found


def placed(frames: Floats, places_mm: Floats) -> Floats:
    """Return where places of a frame are in what it stands in, shape (..., 3)."""
    return np.asarray((frames[..., :3, :3] @ places_mm[..., None])[..., 0] + frames[..., :3, 3])


def _about(axis: int, angles_rad: Floats) -> Floats:
    cosine, sine = np.cos(angles_rad[..., axis]), np.sin(angles_rad[..., axis])
    after, last = (axis + 1) % 3, (axis + 2) % 3
    found = np.zeros((*cosine.shape, 3, 3))
    found[..., axis, axis] = 1.0
    found[..., after, after] = found[..., last, last] = cosine
    found[..., after, last], found[..., last, after] = -sine, sine
    return found
