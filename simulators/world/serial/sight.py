"""Whether an instrument sees a place: cones of retroreflectors and marks, and what the arm's bodies hide."""

from collections.abc import Sequence

import numpy as np

from catseye.simulators.config import SerialBody
from catseye.simulators.world.serial.frames import placed
from catseye.simulators.world.types import Bools, Floats

_SMALLEST = 1e-12


def in_cone(places_mm: Floats, normals: Floats, station_mm: Floats, half_angle_deg: float) -> Bools:
    """Return whether a station stands in the cones about normals.

    Args:
        places_mm: apexes, shape (..., 3).
        normals: axes of length 1, same shape.
        station_mm: shape (..., 3).
    """
    towards = station_mm - places_mm
    cosines = np.einsum("...k,...k->...", towards, normals) / np.linalg.norm(towards, axis=-1)
    return np.asarray(cosines >= np.cos(np.deg2rad(half_angle_deg)))


def clear(bodies: Sequence[SerialBody], frames: Floats, places_mm: Floats, station_mm: Floats) -> Bools:
    """Return whether no body stands between a station and places; one that contains the place is left out.

    Descriptions draw bodies rather too large, so that a place on the flange may be inside of one.

    Args:
        bodies: of the arm.
        frames: of base and joints, shape (m, n + 1, 4, 4).
        places_mm: where one looks, shape (m, 3).
        station_mm: from where, shape (m, 3).
    """
    found = np.ones(len(places_mm), dtype=np.bool_)
    for body in bodies:
        ends = [placed(frames[:, body.frame], np.array(end)) for end in (body.from_mm, body.to_mm)]
        beside = _apart_mm(places_mm, station_mm, *ends) > body.radius_mm
        around = _apart_mm(places_mm, places_mm, *ends) <= body.radius_mm
        found &= beside | around
    return found


def _apart_mm(from_mm: Floats, to_mm: Floats, start_mm: Floats, end_mm: Floats) -> Floats:
    """Return the distances of two segments each, shape (m,) (Ericson, Real-Time Collision Detection, 5.1.9)."""
    one, other, between = to_mm - from_mm, end_mm - start_mm, from_mm - start_mm
    a, e = (np.maximum(_dot(way, way), _SMALLEST) for way in (one, other))
    b, c, f = _dot(one, other), _dot(one, between), _dot(other, between)
    along = np.clip((b * f - c * e) / np.maximum(a * e - b * b, _SMALLEST), 0.0, 1.0)
    beyond = np.clip((b * along + f) / e, 0.0, 1.0)
    along = np.clip((b * beyond - c) / a, 0.0, 1.0)
    apart = between + along[:, None] * one - beyond[:, None] * other
    return np.asarray(np.linalg.norm(apart, axis=1))


def _dot(one: Floats, other: Floats) -> Floats:
    return np.asarray(np.einsum("mk,mk->m", one, other))
