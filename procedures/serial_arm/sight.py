"""What the instrument sees: targets whose normal points to it, with no body of the arm in between."""

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.distances import segment_to_box_mm, segment_to_segment_mm
from catseye.procedures.serial_arm.bench import SerialBench, ToolTarget

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


def places_in_base_mm(bench: SerialBench, poses: Floats, target: ToolTarget) -> Floats:
    """Return where a target of the nominal arm is in the frame of its base, mm, shape (n, 3).

    Args:
        poses: joints, deg or mm, shape (n, joints).
    """
    flange = bench.workspace.chain.flange(poses)
    return np.asarray(flange[:, :3, :3] @ np.array(target.place_mm) + flange[:, :3, 3])


def off_normal_deg(bench: SerialBench, poses: Floats, target: ToolTarget) -> Floats:
    """Return the angle between a target's normal and the line of sight, deg, shape (n,); 0 where it has no normal."""
    if target.normal is None:
        return np.zeros(len(poses))
    flange = bench.workspace.chain.flange(poses)
    normal = flange[:, :3, :3] @ (np.array(target.normal) / np.linalg.norm(target.normal))
    sight = bench.instrument.station_mm - places_in_base_mm(bench, poses, target)
    cosine = np.einsum("ni,ni->n", normal, sight) / np.linalg.norm(sight, axis=1)
    return np.asarray(np.rad2deg(np.arccos(np.clip(cosine, -1.0, 1.0))))


def in_line_of_sight(bench: SerialBench, poses: Floats, target: ToolTarget) -> Bools:
    """Return where no body of the arm and no keep-out box stands between target and instrument, shape (n,).

    Bodies that ride on the last joint carry the target and are left out; the normal of the target tells their side.
    """
    workspace = bench.workspace
    last = len(workspace.chain.joints)
    start = places_in_base_mm(bench, poses, target)
    end = np.broadcast_to(bench.instrument.station_mm, start.shape)
    frames = workspace.chain.frames(poses)
    clear = np.ones(len(poses), dtype=np.bool_)
    for body in workspace.bodies:
        if body.frame == last:
            continue
        ends = [frames[body.frame, :, :3, :3] @ np.array(point) for point in (body.start_mm, body.end_mm)]
        one, other = (point + frames[body.frame, :, :3, 3] for point in ends)
        clear &= segment_to_segment_mm(start, end, one, other) > body.radius_mm
    for box in workspace.keep_out:
        clear &= segment_to_box_mm(start, end, np.array(box.low_mm), np.array(box.high_mm)) > 0.0
    return clear


def seen(bench: SerialBench, poses: Floats, target: ToolTarget, *, as_frame: bool = False) -> Bools:
    """Return where the instrument sees a target, shape (n,).

    Args:
        poses: joints, deg or mm, shape (n, joints).
        as_frame: marks on both faces of a plate that an optical CMM looks at; else a nest that looks one way.
    """
    off = off_normal_deg(bench, poses, target)
    if as_frame and target.normal is not None:
        off = np.minimum(off, 180.0 - off)
    limit = bench.instrument.face_deg if as_frame else bench.instrument.cone_deg
    return (off <= limit) & in_line_of_sight(bench, poses, target)


def best_seen(
    bench: SerialBench, poses: Floats, targets: tuple[ToolTarget, ...], *, as_frame: bool = False
) -> NDArray[np.int64]:
    """Return the number of the target that looks most directly at the instrument, −1 for none, shape (n,)."""
    off = np.array(
        [
            np.where(seen(bench, poses, one, as_frame=as_frame), off_normal_deg(bench, poses, one), np.inf)
            for one in targets
        ]
    )
    return np.where(np.isfinite(off.min(axis=0)), np.argmin(off, axis=0), -1)
