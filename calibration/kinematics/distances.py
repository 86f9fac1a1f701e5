"""Distances between line segments and boxes in space, for any number of them at once.

A capsule is a segment with a radius: what is said of its segment less the radius holds for the capsule.
"""

import numpy as np

from catseye.calibration.kinematics.types import Floats

_POINT_MM2 = 1e-12
"""A segment whose square is shorter is a point."""


def segment_to_segment_mm(start1: Floats, end1: Floats, start2: Floats, end2: Floats) -> Floats:
    """Return the shortest distances between segments (Ericson, Real-Time Collision Detection, 5.1.9).

    Args:
        start1: of the first segments, mm, shape (..., 3).
        end1: of the first segments, likewise.
        start2: of the second segments, likewise.
        end2: of the second segments, likewise.

    Returns:
        mm, shape (...).
    """
    along1, along2, between = end1 - start1, end2 - start2, start1 - start2
    a, e, b = _dot(along1, along1), _dot(along2, along2), _dot(along1, along2)
    c, f = _dot(along1, between), _dot(along2, between)
    safe_a, safe_e = np.maximum(a, _POINT_MM2), np.maximum(e, _POINT_MM2)
    slant = a * e - b * b
    # Of parallel segments any place on the first will do; the second follows it and is clamped.
    free = np.clip((b * f - c * e) / np.where(slant > _POINT_MM2, slant, np.inf), 0.0, 1.0)
    t = np.clip((b * free + f) / safe_e, 0.0, 1.0)
    s = np.clip((b * t - c) / safe_a, 0.0, 1.0)
    gap = between + s[..., None] * along1 - t[..., None] * along2
    return np.sqrt(_dot(gap, gap))


def segment_to_box_mm(start: Floats, end: Floats, low: Floats, high: Floats) -> Floats:
    """Return the shortest distances between segments and boxes along the axes; 0 where they meet.

    The square of the distance along a segment is convex and made of parabolas, with seams where the segment passes
    the planes of the box; each parabola is minimised in closed form.

    Args:
        start: of the segments, mm, shape (..., 3).
        end: of the segments, likewise.
        low: smallest x, y, z of the boxes, mm, broadcast against them.
        high: largest x, y, z of the boxes, likewise.

    Returns:
        mm, shape (...).
    """
    along = end - start
    rate = np.where(np.abs(along) > _POINT_MM2, along, np.inf)
    seams = np.concatenate([(low - start) / rate, (high - start) / rate], axis=-1)
    ends = np.zeros((*seams.shape[:-1], 1))
    at = np.sort(np.concatenate([ends, np.clip(seams, 0.0, 1.0), ends + 1.0], axis=-1), axis=-1)
    # Half the derivative of the square of the distance: linear between the seams, and rising.
    slope = _slope(at, start, along, low, high)
    rise = slope[..., 1:] - slope[..., :-1]
    share = np.clip(-slope[..., :-1] / np.where(rise > 0.0, rise, np.inf), 0.0, 1.0)
    lowest = at[..., :-1] + share * (at[..., 1:] - at[..., :-1])
    excess = _excess(np.concatenate([lowest, at[..., -1:]], axis=-1), start, along, low, high)
    nearest: Floats = np.min(_dot(excess, excess), axis=-1)
    return np.sqrt(nearest)


def depth_in_box_mm(start: Floats, end: Floats, low: Floats, high: Floats) -> Floats:
    """Return how deep segments lie inside boxes: the distance to the nearest face, negative outside.

    Segments, boxes and result are as in `segment_to_box_mm`.
    """
    least, most = np.minimum(start, end), np.maximum(start, end)
    depth: Floats = np.minimum(least - low, high - most).min(axis=-1)
    return depth


def _dot(one: Floats, other: Floats) -> Floats:
    product: Floats = np.einsum("...i,...i->...", one, other)
    return product


def _excess(at: Floats, start: Floats, along: Floats, low: Floats, high: Floats) -> Floats:
    """Return the vectors from boxes to points of segments, shape (..., points, 3)."""
    point = start[..., None, :] + at[..., None] * along[..., None, :]
    return point - np.clip(point, low[..., None, :], high[..., None, :])


def _slope(at: Floats, start: Floats, along: Floats, low: Floats, high: Floats) -> Floats:
    return _dot(_excess(at, start, along, low, high), along[..., None, :])
