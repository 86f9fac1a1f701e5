"""Commands with which the calibrated arm reaches what a program means with the nominal one."""

from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.arguments import require_finite, require_shape
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.kinematics.joint_ranges import beyond_text, ranges_of, within
from catseye.calibration.kinematics.refinement import refine
from catseye.calibration.kinematics.solution import Named
from catseye.calibration.serial_arm.geometry import Commands, Geometry

MOST_CORRECTION = 2.0
"""deg or mm by which a command may differ from the program's: more is needed near singular poses only."""

_ROUNDS = 20
_SETTLED = 1e-10
"""Change of a joint, deg or mm, that ends the search for the command behind a deflection."""


@dataclass(frozen=True)
class Compensated:
    """Commands that stand in for those of a program.

    Attributes:
        joints: deg or mm, NaN in the rows that `refused` names, shape (n, joints).
        uncorrected_mm: how far the arm would miss each pose without compensation, at the tool, shape (n,).
        refused: rows that the calibrated arm does not reach, with the reason.
    """

    joints: Floats
    uncorrected_mm: Floats
    refused: tuple[Named, ...]


def compensate(geometry: Geometry, poses: Floats, tool: Floats | None = None) -> Compensated:
    """Return the commands of the calibrated arm for poses of a program.

    Each pose means the frame that the nominal arm has there; the base of both arms is the same. Approach is from
    below, as while measuring.

    Args:
        poses: joints of the program, deg or mm, shape (n, joints).
        tool: the tool centre point in the flange, shape (4, 4); the flange itself without one.
    """
    nominal, real = geometry.arm.chain, geometry.chain
    require_shape(poses, (None, len(nominal.joints)), "poses")
    require_finite(poses, "poses")
    at_tool = np.eye(4) if tool is None else tool
    meant = nominal.flange(poses) @ at_tool
    there = real.flange(geometry.reached(Commands.of(geometry.arm, poses))) @ at_tool
    found = refine(real, meant, poses, at_tool)
    joints, settled = _behind(geometry, found.poses)
    inside = within(joints, *ranges_of(nominal)).all(axis=1)
    near = np.abs(joints - poses).max(axis=1) <= MOST_CORRECTION
    good = found.reached & settled
    refused = tuple(
        Named(
            int(row), _reason(geometry, poses[row], joints[row], good=bool(good[row]), near=bool(near[row]))
        )
        for row in np.flatnonzero(~(good & inside & near))
    )
    joints[[one.row for one in refused]] = np.nan
    return Compensated(joints, np.linalg.norm(there[:, :3, 3] - meant[:, :3, 3], axis=1), refused)


def _behind(geometry: Geometry, reached: Floats) -> tuple[Floats, Bools]:
    """Return the commands that reach joints through deflections and periodic errors, and which have settled."""
    joints = reached.copy()
    change = np.full(len(joints), np.inf)
    for _ in range(_ROUNDS):
        missed = reached - geometry.reached(Commands.of(geometry.arm, joints))
        joints += missed
        change = np.abs(missed).max(axis=1, initial=0.0)
        if change.max(initial=0.0) < _SETTLED:
            break
    return joints, change < _SETTLED


def _reason(geometry: Geometry, pose: Floats, joints: Floats, *, good: bool, near: bool) -> str:
    if not good:
        return (
            "the calibrated arm does not reach it in the same configuration: it lies at the edge of its reach"
        )
    if not near:
        names, worst = geometry.arm.joint_names, int(np.argmax(np.abs(joints - pose)))
        return (
            f"{names[worst]} would have to move by {joints[worst] - pose[worst]:+.3g} more: the pose is close to a "
            "singular one, where small errors need large corrections"
        )
    return beyond_text(geometry.arm.chain, joints)
