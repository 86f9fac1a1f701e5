"""Whether an instrument sees what an arm carries: the one rule of pose selection, plans and the way to each pose.

A retroreflector is seen within a cone about the direction in which it looks, a plate with marks on both faces within
an angle of either face, and a target without a direction from everywhere; nothing may stand in between.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.kinematics.bodies import Box, Capsule, Point
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.distances import segment_to_box_mm, segment_to_segment_mm

_SHORTEST_MM = 1e-9


@dataclass(frozen=True)
class Sighted:
    """What is looked at.

    Attributes:
        place_mm: in the frame of the flange.
        normal: direction in which it looks, in that frame, of any length; None where it is seen from everywhere.
    """

    place_mm: Point
    normal: Point | None = None


@dataclass(frozen=True)
class View:
    """What an instrument on its stand sees of an arm.

    Attributes:
        station_mm: in the frame of the arm's base.
        within_deg: largest angle between a normal and the line of sight.
        both_faces: what is looked at has marks on both faces; else it looks one way.
        bodies: that may stand in the line of sight, in their frames.
        boxes: likewise, in the frame of the base.
    """

    station_mm: Point
    within_deg: float = 30.0
    both_faces: bool = False
    bodies: tuple[Capsule, ...] = ()
    boxes: tuple[Box, ...] = ()


def off_normal_deg(view: View, flange: Floats, target: Sighted) -> Floats:
    """Return the angle between the line of sight and where a target looks, deg; 0 where it has no normal.

    Args:
        flange: frames of the flange, shape (n, 4, 4).

    Returns:
        From the nearer of two faces; shape (n,).
    """
    if target.normal is None:
        return np.zeros(len(flange))
    looks = flange[:, :3, :3] @ (np.array(target.normal) / np.linalg.norm(target.normal))
    sight = np.array(view.station_mm) - _places_mm(flange, target)
    length = np.maximum(np.linalg.norm(sight, axis=1), _SHORTEST_MM)
    cosine = np.einsum("ni,ni->n", looks, sight) / length
    if view.both_faces:
        cosine = np.abs(cosine)
    return np.asarray(np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0))))


def in_line_of_sight(view: View, frames: Floats, target: Sighted) -> Bools:
    """Return where nothing stands between a target and the instrument, shape (n,).

    Bodies are drawn rather too large: one that contains the target carries it and does not hide it.

    Args:
        frames: of base and joints, shape (joints + 1, n, 4, 4).
    """
    place = _places_mm(frames[-1], target)
    station = np.broadcast_to(np.array(view.station_mm), place.shape)
    clear = np.ones(len(place), dtype=np.bool_)
    for body in view.bodies:
        frame = frames[body.frame]
        start, end = (
            frame[:, :3, :3] @ np.array(point) + frame[:, :3, 3] for point in (body.start_mm, body.end_mm)
        )
        beside = segment_to_segment_mm(place, station, start, end) > body.radius_mm
        clear &= beside | (segment_to_segment_mm(place, place, start, end) <= body.radius_mm)
    for box in view.boxes:
        clear &= segment_to_box_mm(place, station, np.array(box.low_mm), np.array(box.high_mm)) > 0.0
    return clear


def sight_angles_deg(view: View, chain: Chain, poses: Floats, targets: Sequence[Sighted]) -> Floats:
    """Return how far each target looks past the instrument, infinite where it is not seen.

    Args:
        poses: joints, deg or mm, shape (n, joints).

    Returns:
        deg, shape (targets, n).
    """
    frames = chain.frames(poses)
    found = np.full((len(targets), len(poses)), np.inf)
    for number, target in enumerate(targets):
        off = off_normal_deg(view, frames[-1], target)
        near = np.flatnonzero(off <= view.within_deg)
        near = near[in_line_of_sight(view, frames[:, near], target)]
        found[number, near] = off[near]
    return found


def straightest(angles_deg: Floats, most: int) -> Ints:
    """Return the targets that look most directly at the instrument, the best first.

    Args:
        angles_deg: as `sight_angles_deg` returns them, shape (targets, n).
        most: wanted of each pose.

    Returns:
        Their numbers, −1 behind the last that is seen, shape (n, at most `most`).
    """
    order = np.argsort(angles_deg.T, axis=1, kind="stable")[:, :most]
    return np.where(np.isfinite(np.take_along_axis(angles_deg.T, order, axis=1)), order, -1)


def _places_mm(flange: Floats, target: Sighted) -> Floats:
    return np.asarray(flange[:, :3, :3] @ np.array(target.place_mm) + flange[:, :3, 3])
