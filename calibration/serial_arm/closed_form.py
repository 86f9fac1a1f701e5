"""Where base, unknown targets, anchors and dead paths are, from the nominal arm: the start of everything else."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Floats
from catseye.calibration.kinematics.rotations import angles_of
from catseye.calibration.serial_arm.arm import Anchor, SerialArm
from catseye.calibration.serial_arm.measurements import Measurements

_ROUNDS = 100
"""Places of base and targets in turn; each round takes more than half of what is left."""

_STEPS = 10
"""Gauss-Newton steps from a closed form: each squares what is left."""

_FLAT = 1e-9
"""Points whose second principal extension is below this share of the first lie on a line."""


@dataclass(frozen=True)
class Start:
    """Where an iteration starts.

    Attributes:
        frame: the base in the frame of the instrument, shape (4, 4).
        values: of parameters that have no nominal value, by name.
    """

    frame: Floats
    values: Mapping[str, float] = field(default_factory=dict)


def rigid_motion(points_mm: Floats, seen_mm: Floats) -> Floats:
    """Return the motion that brings points as near as possible to where they are seen (Kabsch 1976; Umeyama 1991).

    Args:
        points_mm: in one frame, shape (n, 3).
        seen_mm: the same in another frame, shape (n, 3).

    Returns:
        Homogeneous transform, never a reflection, shape (4, 4).

    Raises:
        InsufficientPointsError: fewer than three points, or all on a line.
    """
    if len(points_mm) < 3:
        raise InsufficientPointsError(
            f"{len(points_mm)} points do not fix a frame: measure at least three that are not on a line"
        )
    middle, seen_middle = points_mm.mean(axis=0), seen_mm.mean(axis=0)
    left, values, right = np.linalg.svd((seen_mm - seen_middle).T @ (points_mm - middle))
    if values[1] <= _FLAT * values[0]:
        raise InsufficientPointsError(
            "all points lie on a line, and the frame may turn about it: measure points beside it"
        )
    handed = np.array([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    motion = np.eye(4)
    motion[:3, :3] = (left * handed) @ right
    motion[:3, 3] = seen_middle - motion[:3, :3] @ middle
    return motion


def closed_form(arm: SerialArm, measurements: Measurements) -> Start:
    """Return where the nominal arm stands, from points if there are any, otherwise from distances.

    Raises:
        InsufficientPointsError: too few points or distances, or all on a line.
    """
    if not len(measurements.points.pose):
        return _from_distances(arm, measurements, None)
    start = _from_points(arm, measurements)
    values = {**start.values, **_turned_frames(arm, measurements, start.frame)}
    if len(measurements.distances.pose):
        values |= _from_distances(arm, measurements, start.frame).values
    return Start(start.frame, values)


def _turned_frames(arm: SerialArm, measurements: Measurements, frame: Floats) -> dict[str, float]:
    """Return the angles of frames on the flange: of the mean of what each pose shows."""
    rows = measurements.orientations
    flange = frame[:3, :3] @ arm.chain.flange(measurements.commands.joints)[rows.pose, :3, :3]
    seen = flange.transpose(0, 2, 1) @ rows.rotation
    found: dict[str, float] = {}
    for k in np.unique(rows.target).tolist():
        if arm.targets[k].turned:
            left, _, right = np.linalg.svd(seen[rows.target == k].sum(axis=0))
            handed = np.array([1.0, 1.0, np.linalg.det(left @ right)])
            angles = angles_of((left * handed) @ right)
            found |= {f"{arm.targets[k].name}.r{a}_deg": float(v) for a, v in zip("xyz", angles, strict=True)}
    return found


def _from_points(arm: SerialArm, measurements: Measurements) -> Start:
    """Return base and unknown targets: the one from the other in turn, each in closed form, until both stay."""
    rows = measurements.points
    flange = arm.chain.flange(measurements.commands.joints)[rows.pose]
    places = np.array([target.place_mm for target in arm.targets])
    unknown = [k for k, target in enumerate(arm.targets) if target.u_mm is None and k in rows.target]
    frame = np.eye(4)
    for _ in range(_ROUNDS if unknown else 1):
        points = np.einsum("nij,nj->ni", flange[:, :3, :3], places[rows.target]) + flange[:, :3, 3]
        frame = rigid_motion(points, rows.place_mm)
        back = (rows.place_mm - frame[:3, 3]) @ frame[:3, :3]
        for k in unknown:
            of_it = rows.target == k
            apart = np.einsum("nji,nj->ni", flange[of_it, :3, :3], back[of_it] - flange[of_it, :3, 3])
            places[k] = apart.mean(axis=0)
    names = [
        (f"{arm.targets[k].name}.{axis}_mm", places[k, j]) for k in unknown for j, axis in enumerate("xyz")
    ]
    return Start(frame, {name: float(value) for name, value in names})


def _from_distances(arm: SerialArm, measurements: Measurements, frame: Floats | None) -> Start:
    """Return anchors and dead paths; and the base, where nothing else says where it is."""
    rows = measurements.distances
    flange = arm.chain.flange(measurements.commands.joints)[rows.pose]
    tools = np.array([target.place_mm for target in arm.targets])
    places = np.einsum("nij,nj->ni", flange[:, :3, :3], tools[rows.target]) + flange[:, :3, 3]
    used = np.unique(rows.anchor).tolist()
    found = {k: anchor_of(places, measurements, k) for k in used}
    if frame is None:
        frame = _onto_anchors({k: place for k, (place, _) in found.items()}, rows.anchors)
    values: dict[str, float] = {}
    for k, (place, dead_paths) in found.items():
        seen = frame[:3, :3] @ place + frame[:3, 3]
        values |= {f"{rows.anchors[k].name}.{axis}_mm": float(v) for axis, v in zip("xyz", seen, strict=True)}
        values |= {f"{rows.segments[s]}.dead_path_mm": value for s, value in dead_paths.items()}
    return Start(frame, values)


def anchor_of(places_mm: Floats, measurements: Measurements, anchor: int) -> tuple[Floats, dict[int, float]]:
    """Return an anchor in the frame of the places and the dead paths of its segments.

    With a the anchor, x a target and c the dead path, |x − a| = d + c is linear in a, c and c² − |a|².

    Args:
        places_mm: of the target at every distance, shape (m, 3).

    Raises:
        InsufficientPointsError: too few distances.
    """
    rows = measurements.distances
    of_it = rows.anchor == anchor
    x, d, segment = places_mm[of_it], rows.distance_mm[of_it], rows.segment[of_it]
    segments = np.unique(segment)
    lengths = [np.where(segment == s, d, 0.0) for s in segments if s >= 0]
    levels = [(segment == s).astype(np.float64) for s in segments]
    columns = np.column_stack([2.0 * x, *(2.0 * one for one in lengths), *levels])
    if len(x) < columns.shape[1]:
        raise InsufficientPointsError(
            f"{rows.anchors[anchor].name}: {len(x)} distances do not say where it is: "
            f"measure at least {columns.shape[1]}"
        )
    scale = np.linalg.norm(columns, axis=0)
    solved = np.linalg.lstsq(columns / scale, np.sum(x**2, axis=1) - d**2, rcond=None)[0] / scale
    relative = [int(s) for s in segments if s >= 0]
    return solved[:3], {s: float(solved[3 + k]) for k, s in enumerate(relative)}


def refined_anchor(
    places_mm: Floats, measurements: Measurements, anchor: int
) -> tuple[Floats, dict[int, float]]:
    """Return an anchor and dead paths that leave the least squares of distances, from where a closed form puts them.

    Raises:
        InsufficientPointsError: too few distances.
    """
    place, dead_paths = anchor_of(places_mm, measurements, anchor)
    rows = measurements.distances
    of_it = rows.anchor == anchor
    x, d, segment = places_mm[of_it], rows.distance_mm[of_it], rows.segment[of_it]
    shares = np.column_stack([segment == s for s in dead_paths] or [np.zeros((len(x), 0))]).astype(np.float64)
    paths = np.array(list(dead_paths.values()))
    for _ in range(_STEPS):
        beam = x - place
        length = np.linalg.norm(beam, axis=1)
        slopes = np.column_stack([-beam / length[:, None], -shares])
        step = np.linalg.lstsq(slopes, d + shares @ paths - length, rcond=None)[0]
        place, paths = place + step[:3], paths + step[3:]
    return place, dict(zip(dead_paths, paths.tolist(), strict=True))


def _onto_anchors(found: Mapping[int, Floats], anchors: tuple[Anchor, ...]) -> Floats:
    """Return the motion that brings anchors, found in the frame of the base, onto their known places."""
    pairs = [(found[k], anchors[k].place_mm) for k in found if anchors[k].u_mm is not None]
    if len(pairs) >= 3:
        return rigid_motion(np.array([one for one, _ in pairs]), np.array([place for _, place in pairs]))
    frame = np.eye(4)
    if pairs:
        frame[:3, 3] = np.mean([np.subtract(place, one) for one, place in pairs], axis=0)
    return frame
