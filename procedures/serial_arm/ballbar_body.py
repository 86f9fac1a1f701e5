"""The bar itself on its way: no body of the arm, no keep-out box and not the table may come near it."""

from itertools import pairwise
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.kinematics.distances import segment_to_box_mm, segment_to_segment_mm
from catseye.drivers.roles.pose import Pose, pose_text
from catseye.procedures.kit.bench import Workspace
from catseye.procedures.kit.errors import PlanError
from catseye.procedures.serial_arm.bench import Ballbar, SerialBench, ToolTarget

Floats = NDArray[np.float64]

_FREE_MM: Final = 25.0
"""At either end, where cup and nest hold the bar and nothing else is to be told apart from them."""

_LOOK_DEG: Final = 0.25
"""Between two looks no joint turns farther: a body 0.6 m from its axis moves by 3 mm."""


def require_clear_bar(
    bench: SerialBench, ballbar: Ballbar, nest: ToolTarget, commands: tuple[Pose, ...]
) -> None:
    """Refuse a path on which something comes near the bar, at its commands or between them.

    Args:
        commands: in order; straight joint moves lie between them.

    Raises:
        PlanError: names what comes near the bar, and where the arm stands then.
    """
    poses = _looks(np.array(commands))
    names, gaps_mm = _gaps(bench.workspace, ballbar, nest, poses)
    least = bench.workspace.clearance_mm
    near = np.argwhere((gaps_mm < least).T)
    if len(near):
        row, body = near[0].tolist()
        apart_mm = max(float(gaps_mm[body, row]), 0.0)
        raise PlanError(
            f"{nest.name}: the {names[body]} comes within {apart_mm:.1f} mm of the ballbar "
            f"({least:g} mm are kept free) near {pose_text(bench.arm.axes, tuple(poses[row].tolist()), digits=1)}: "
            "choose other ranges of azimuth and elevation, or place the cup elsewhere (centre_mm in [ballbar])"
        )


def _looks(commands: Floats) -> Floats:
    """Return the commands with so many places between them that no joint turns far from one to the next."""
    found = [commands[:1]]
    for before, after in pairwise(commands):
        count = max(int(np.ceil(np.abs(after - before).max() / _LOOK_DEG)), 1)
        shares = np.arange(1, count + 1)[:, None] / count
        found.append(before + shares * (after - before))
    return np.concatenate(found)


def _gaps(
    workspace: Workspace, ballbar: Ballbar, nest: ToolTarget, poses: Floats
) -> tuple[list[str], Floats]:
    """Return what may come near the bar, and how near it is at each pose, mm, shape (things, poses)."""
    frames = workspace.chain.frames(poses)
    cup = np.array(ballbar.centre_mm)
    held = (frames[-1] @ np.array([*nest.place_mm, 1.0]))[:, :3]
    along = (held - cup) / np.linalg.norm(held - cup, axis=1, keepdims=True)
    low, high = cup + _FREE_MM * along, held - _FREE_MM * along
    names, gaps = [], []
    for body in workspace.bodies:
        ends = [(frames[body.frame] @ np.array([*end, 1.0]))[:, :3] for end in (body.start_mm, body.end_mm)]
        names.append(body.name)
        gaps.append(segment_to_segment_mm(low, high, *ends) - body.radius_mm)
    for box in workspace.keep_out:
        names.append(f"keep-out box {box.name}")
        gaps.append(segment_to_box_mm(low, high, np.array(box.low_mm), np.array(box.high_mm)))
    names.append("table")
    gaps.append(np.minimum(low[:, 2], high[:, 2]) - workspace.table_z_mm)
    return names, np.array(gaps) - ballbar.radius_mm
