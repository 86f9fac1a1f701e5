"""Commands with which the calibrated arm reaches what a program means with the nominal one."""

from dataclasses import dataclass, replace

import numpy as np

from catseye.calibration.core.arguments import require_finite, require_shape
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.kinematics.chain import Chain
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


def compensate(
    geometry: Geometry, poses: Floats, tool: Floats | None = None, approach: Floats | None = None
) -> Compensated:
    """Return the commands of the calibrated arm for poses of a program.

    Each pose means the frame that the nominal arm has there; the base of both arms is the same.

    Args:
        poses: joints of the program, deg or mm, shape (n, joints).
        tool: the tool centre point in the flange, shape (4, 4); the flange itself without one.
        approach: side that each joint comes from, 1 from below, −1 from above, shape (n, joints); from below without
            it.
    """
    nominal, real = geometry.arm.chain, geometry.chain
    require_shape(poses, (None, len(nominal.joints)), "poses")
    require_finite(poses, "poses")
    at_tool = np.eye(4) if tool is None else tool
    meant = nominal.flange(poses) @ at_tool
    there = real.flange(geometry.reached(Commands.of(geometry.arm, poses, approach))) @ at_tool
    found = refine(real, meant, poses, at_tool)
    joints, settled = _behind(geometry, found.poses, approach)
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


def with_approach(chain: Chain, found: Compensated, approach: Floats, by: float) -> Compensated:
    """Return the commands with those refused whose approach begins beyond the ranges of the joints.

    Args:
        approach: side that each joint comes from, shape (n, joints).
        by: deg or mm on that side, from where each pose is driven.
    """
    before = found.joints - by * approach
    gone = {one.row for one in found.refused}
    beyond = ~within(before, *ranges_of(chain)).all(axis=1)
    refused = [
        Named(int(row), f"its approach from {by:g} on its side: {beyond_text(chain, before[row])}")
        for row in np.flatnonzero(beyond)
        if row not in gone
    ]
    joints = found.joints.copy()
    joints[[one.row for one in refused]] = np.nan
    return replace(
        found, joints=joints, refused=tuple(sorted((*found.refused, *refused), key=lambda one: one.row))
    )


def _behind(geometry: Geometry, reached: Floats, approach: Floats | None) -> tuple[Floats, Bools]:
    """Return the commands that reach joints through deflections, maps and backlash, and which have settled."""
    joints = reached.copy()
    change = np.full(len(joints), np.inf)
    for _ in range(_ROUNDS):
        missed = reached - geometry.reached(Commands.of(geometry.arm, joints, approach))
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
