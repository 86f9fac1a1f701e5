"""Commanded steps of the tool at a pose, the joint increments that make them, and what comes of them in draws."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.calibration.core.arguments import require_count, require_positive
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.kinematics.chain import Chain
from catseye.calibration.kinematics.finite_motion import FiniteMotion
from catseye.calibration.kinematics.joint_ranges import beyond_text, ranges_of, within
from catseye.calibration.resolution.joint_lookup import JointLookup
from catseye.calibration.resolution.tables import ResolutionTables

DIRECTIONS: Final = ("+X", "-X", "+Y", "-Y", "+Z", "-Z", "+RX", "-RX", "+RY", "-RY", "+RZ", "-RZ")
"""Of the tool along the axes of the base, and about them through the tool centre point."""

_UNITS: Final = np.repeat(np.eye(6), 2, axis=0) * np.tile([1.0, -1.0], 6)[:, None]
"""Motions of one mm or one deg in the directions, shape (directions, 6)."""


_WAYS: Final = 6
"""In which a tool can be moved."""


@dataclass(frozen=True)
class StepSeries:
    """Commanded steps that decrease exponentially.

    Attributes:
        largest_mm: first step of translations.
        largest_deg: first step of rotations, which the paper leaves out: joints' tables end at 0.1°, and wrists turn
            up to three times as far as the tool.
        ratio: of one step to the next, that of the paper's test of joints.
        count: how many.
    """

    largest_mm: float = 1.0
    largest_deg: float = 0.03
    ratio: float = 1.072267
    count: int = 109

    def __post_init__(self) -> None:
        require_positive([self.largest_mm, self.largest_deg], "largest steps")
        require_positive(self.ratio - 1.0, "ratio of steps less 1")
        require_count(self.count, "steps", 2)

    def sizes(self) -> Floats:
        """Return the steps of all directions, mm or deg, shape (directions, count)."""
        largest = np.repeat([self.largest_mm, self.largest_deg], len(DIRECTIONS) // 2)
        return largest[:, None] * self.ratio ** -np.arange(self.count, dtype=np.float64)


@dataclass(frozen=True)
class StepDraws:
    """What comes of the steps of one direction.

    Attributes:
        along_percent: error along the direction, of the step, shape (steps, draws).
        across_percent: motion across it: displacement of a translation, rotation of a rotation; same shape.
    """

    along_percent: Floats
    across_percent: Floats


class CartesianSteps:
    """Steps of all directions from a pose.

    Args:
        chain: the arm.
        pose: joints, deg or mm, shape (joints,).
        tables: step errors of the joints.
        series: commanded steps.
        tool: the tool centre point in the last frame, shape (4, 4); that frame itself without one.
        approach: as `JointLookup` takes it.

    Attributes:
        sizes: mm or deg, shape (directions, steps).
        increments: of the joints, deg or mm, shape (directions, steps, joints).
        open_percent: what joints without known errors may contribute to the error at worst, of the step, shape
            (directions, steps); infinite where the arm cannot make the step.
    """

    def __init__(
        self,
        chain: Chain,
        pose: Floats,
        tables: ResolutionTables,
        series: StepSeries,
        tool: Floats | None,
        approach: Ints | None,
    ) -> None:
        self._chain, self._pose = chain, pose
        self._motion = FiniteMotion(chain, pose, tool)
        self._lookup = JointLookup(chain, pose, tables, approach)
        self.sizes = series.sizes()
        solved = self._motion.increments_for((self.sizes[..., None] * _UNITS[:, None]).reshape(-1, 6))
        self.increments: Floats = solved.joints.reshape(*self.sizes.shape, -1)
        self._made: Bools = solved.reached.reshape(self.sizes.shape)
        self._inside: Bools = np.all(within(pose + self.increments, *ranges_of(chain)), axis=-1)
        self._known = self._lookup.known(self.increments)
        # What each joint contributes to the motion along the direction, as part of the step.
        along = np.abs((_UNITS @ self._motion.jacobian)[:, None] * self.increments)
        self._open: Floats = self._known.unknown * along / self.sizes[..., None]
        possible = self._made & self._inside
        self.open_percent: Floats = np.where(possible, 100.0 * self._open.sum(axis=-1), np.inf)

    def why_open(self, direction: int, step: int) -> str:
        """Return why the error of a step is not known: the arm does not make it, or a joint's table ends."""
        if not self._made[direction, step]:
            return f"the arm cannot make this motion: {self._why_not_made()}"
        if not self._inside[direction, step]:
            return beyond_text(self._chain, self._pose + self.increments[direction, step])
        joint = int(np.argmax(self._open[direction, step]))
        return self._lookup.why_unknown(joint, float(self.increments[direction, step, joint]))

    def _why_not_made(self) -> str:
        if self._motion.rank < _WAYS:
            return f"at this pose its joints move the tool in {self._motion.rank} of {_WAYS} ways"
        return "it stands near a singular pose or the end of its reach"

    def draw(self, direction: int, count: int, draws: int, rng: np.random.Generator) -> StepDraws:
        """Return what comes of the first steps of a direction.

        Args:
            direction: its number in `DIRECTIONS`.
            count: of steps, from the largest on.
            draws: each of them is one run: what is not known of a joint's mean is the same in all its steps.
        """
        moved = self._motion.of(self._moved(direction, count, draws, rng))
        kind = slice(0, 3) if direction < len(DIRECTIONS) // 2 else slice(3, 6)
        moved, unit, size = moved[..., kind], _UNITS[direction, kind], self.sizes[direction, :count, None]
        along = moved @ unit
        across = np.linalg.norm(moved - along[..., None] * unit, axis=-1)
        return StepDraws(100.0 * (along / size - 1.0), 100.0 * across / size)

    def _moved(self, direction: int, count: int, draws: int, rng: np.random.Generator) -> Floats:
        """Return joint increments with errors, deg or mm, shape (steps, draws, joints)."""
        part = (direction, slice(0, count))
        increments, unknown, lost = (
            values[part][:, None] for values in (self.increments, self._known.unknown, self._known.lost)
        )
        errors = self._known.errors
        joints = increments.shape[-1]
        percent = errors.mean_percent[part][:, None] + errors.u_mean_percent[part][:, None] * rng.normal(
            size=(draws, joints)
        )
        percent = percent + errors.scatter_percent[part][:, None] * rng.normal(size=(count, draws, joints))
        # A joint without known errors stands still at worst, or goes twice as far.
        percent = np.where(unknown, 100.0 * rng.uniform(-1.0, 1.0, (draws, joints)), percent)
        sizes = np.abs(increments) * (1.0 + 0.01 * percent)
        sizes = np.where(lost > 0.0, np.maximum(sizes - lost, 0.0), sizes)
        moved: Floats = np.sign(increments) * sizes
        return moved
