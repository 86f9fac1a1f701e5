"""What the instrument of a bench sees of the targets on the tool."""

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.serial_arm.sight import Sighted, View, sight_angles_deg, straightest
from catseye.procedures.serial_arm.bench import SerialBench, ToolTarget

Floats = NDArray[np.float64]
Bools = NDArray[np.bool_]


def view_of(bench: SerialBench, *, as_frame: bool = False) -> View:
    """Return what the instrument sees of the arm, with all that may stand in between.

    Args:
        as_frame: marks on both faces of a plate that an optical CMM looks at; else nests that look one way.
    """
    workspace, instrument = bench.workspace, bench.instrument
    x_mm, y_mm, z_mm = instrument.station_mm.tolist()
    return View(
        (x_mm, y_mm, z_mm),
        instrument.face_deg if as_frame else instrument.cone_deg,
        as_frame,
        (*workspace.bodies, *(stand.body for stand in bench.stands)),
        workspace.keep_out,
    )


def sighted(target: ToolTarget) -> Sighted:
    """Return a target as something to look at."""
    return Sighted(target.place_mm, target.normal)


def sight_deg(
    bench: SerialBench, poses: Floats, targets: tuple[ToolTarget, ...], *, as_frame: bool = False
) -> Floats:
    """Return how far each target looks past the instrument, deg, infinite where it is not seen.

    Args:
        poses: joints, deg or mm, shape (n, joints).

    Returns:
        Shape (targets, n).
    """
    view = view_of(bench, as_frame=as_frame)
    return sight_angles_deg(view, bench.workspace.chain, poses, tuple(map(sighted, targets)))


def seen(bench: SerialBench, poses: Floats, target: ToolTarget, *, as_frame: bool = False) -> Bools:
    """Return where the instrument sees a target, shape (n,); see `sight_deg`."""
    return np.asarray(np.isfinite(sight_deg(bench, poses, (target,), as_frame=as_frame)[0]))


def best_seen(
    bench: SerialBench, poses: Floats, targets: tuple[ToolTarget, ...], *, as_frame: bool = False
) -> NDArray[np.int64]:
    """Return the number of the target that looks most directly at the instrument, −1 for none, shape (n,)."""
    return straightest(sight_deg(bench, poses, targets, as_frame=as_frame), 1)[:, 0]
