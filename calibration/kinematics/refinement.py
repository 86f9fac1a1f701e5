"""The inverse of any serial arm by damped Newton steps from given joints, for many poses at once.

Levenberg's damping in the scale of the joints (Marquardt 1963); the steps become Newton's near the solution. An arm
with fewer than six joints reaches only poses that it can have.
"""

import math
from dataclasses import dataclass

import numpy as np

from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.jacobian import jacobian_of_frames
from catseye.calibration.kinematics.rotations import rotation_vectors_deg
from catseye.calibration.kinematics.types import Bools, Floats

MISS_MM = 1e-6
"""Where a pose counts as reached; so does its orientation, at the length of the arm."""

_DONE_MM = 1e-9
"""Where only rounding is left."""

_GAIN = 1e-6
"""Share of the error's square below which a step brings nothing: the target cannot be reached from here."""

_STEPS = 80
_FIRST_DAMPING = 1e-3
_LEAST_DAMPING, _MOST_DAMPING = 1e-15, 1e8


@dataclass(frozen=True)
class Refined:
    """Where the steps have ended.

    Attributes:
        poses: joints, deg or mm, shape (n, joints).
        miss_mm: distance from the target, shape (n,).
        miss_deg: angle from the target's orientation, shape (n,).
        reached: both are as good as zero, shape (n,).
    """

    poses: Floats
    miss_mm: Floats
    miss_deg: Floats
    reached: Bools


@dataclass
class _State:
    """Rows that go on: joints, error (mm, and deg times mm per deg), its square, and damping."""

    q: Floats
    error: Floats
    jacobian: Floats
    damping: Floats

    @property
    def square(self) -> Floats:
        squares: Floats = np.einsum("ni,ni->n", self.error, self.error)
        return squares


def refine(chain: Chain, targets: Floats, starts: Floats, tool: Floats | None = None) -> Refined:
    """Step from given joints towards targets; limits are not looked at.

    Args:
        targets: the tool centre point in the base, mm, shape (n, 4, 4).
        starts: joints to begin with, deg or mm, shape (n, joints).
        tool: the tool centre point in the last frame, shape (4, 4); that frame itself without one.
    """
    lever_mm = _mm_per_deg(chain)
    poses = np.array(starts, dtype=np.float64)
    active = np.arange(len(poses))
    state = _State(
        poses.copy(), *_errors(chain, targets, poses, tool, lever_mm), np.full(len(poses), _FIRST_DAMPING)
    )
    errors = state.error.copy()
    for _ in range(_STEPS):
        if not active.size:
            break
        before = state.square
        improved = _step(chain, targets[active], state, tool, lever_mm)
        poses[active], errors[active] = state.q, state.error
        gained = state.square < (1.0 - _GAIN) * before
        still = (state.square > _DONE_MM**2) & np.where(improved, gained, state.damping < _MOST_DAMPING)
        active = active[still]
        state = _State(state.q[still], state.error[still], state.jacobian[still], state.damping[still])
    miss_mm = np.linalg.norm(errors[:, :3], axis=1)
    miss_deg = np.linalg.norm(errors[:, 3:], axis=1) / lever_mm
    return Refined(poses, miss_mm, miss_deg, (miss_mm <= MISS_MM) & (miss_deg * lever_mm <= MISS_MM))


def _step(chain: Chain, targets: Floats, state: _State, tool: Floats | None, lever_mm: float) -> Bools:
    """Step where that brings rows nearer to their targets, and return where it did, shape (n,)."""
    across = state.jacobian.transpose(0, 2, 1)
    normal = across @ state.jacobian
    scale = np.einsum("nii->ni", normal).copy()
    scale += 1e-12 * scale.max(axis=1, keepdims=True)
    damped = normal + (state.damping[:, None] * scale)[:, :, None] * np.eye(scale.shape[1])
    change = np.linalg.solve(damped, (across @ state.error[:, :, None]))[..., 0]
    q = state.q + change
    error, slope = _errors(chain, targets, q, tool, lever_mm)
    improved: Bools = np.einsum("ni,ni->n", error, error) < state.square
    state.q[improved], state.error[improved] = q[improved], error[improved]
    state.jacobian[improved] = slope[improved]
    state.damping = np.where(improved, state.damping * 1e-2, state.damping * 10.0)
    state.damping = np.clip(state.damping, _LEAST_DAMPING, _MOST_DAMPING)
    return improved


def _errors(
    chain: Chain, targets: Floats, q: Floats, tool: Floats | None, lever_mm: float
) -> tuple[Floats, Floats]:
    """Return what is left to the targets, shape (n, 6), and the Jacobian in the same units."""
    frames = chain.frames(q)
    tip = frames[-1] if tool is None else frames[-1] @ tool
    turn = targets[:, :3, :3] @ tip[:, :3, :3].transpose(0, 2, 1)
    error = np.concatenate([targets[:, :3, 3] - tip[:, :3, 3], lever_mm * rotation_vectors_deg(turn)], axis=1)
    slope = jacobian_of_frames(chain, frames, tip)
    slope[:, 3:] *= lever_mm
    return error, slope


def _mm_per_deg(chain: Chain) -> float:
    """Return the weight of orientation against place: the arm's length times an angle."""
    length_mm = sum(math.hypot(joint.a_mm, joint.longest_mm) for joint in chain.joints)
    return math.radians(max(length_mm, 1.0))
