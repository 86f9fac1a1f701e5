"""Poses that may be chosen: drawn within the joints' ranges, kept where no bodies meet and a target is seen."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.kinematics.bodies import Gaps, Point, Scene
from catseye.calibration.kinematics.joint_ranges import ranges_of
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.sight import Sighted, View, sight_angles_deg, straightest

DIGITS = 4
"""Decimals of a pose, deg or mm."""

_BATCH = 5000
_MOST_BATCHES = 200


@dataclass(frozen=True)
class Sight:
    """An instrument and where the targets look.

    Attributes:
        view: what the instrument sees.
        normals: direction in which each target looks, in the frame of the flange; None of one seen from everywhere.
    """

    view: View
    normals: tuple[Point | None, ...]


@dataclass(frozen=True)
class Rules:
    """What a pose has to keep.

    Attributes:
        scene: bodies of the arm and what stands around it; None where none counts.
        sight: None where the instrument follows the target everywhere.
        approach: by how much below the pose each joint begins its last move, deg or mm.
        gap_mm: that bodies keep from each other.
        low: smallest joints, deg or mm, shape (joints,); None: those of the arm.
        high: largest.
        targets_per_pose: that are measured at one, as far as they are seen.
    """

    scene: Scene | None = None
    sight: Sight | None = None
    approach: float = 5.0
    gap_mm: float = 10.0
    low: Floats | None = None
    high: Floats | None = None
    targets_per_pose: int = 1


@dataclass(frozen=True)
class Candidates:
    """Poses that keep the rules.

    Attributes:
        joints: deg or mm, shape (n, joints).
        targets: numbers of the targets that are measured at each, −1 behind the last, shape (n, most).
        drawn: poses that were tried.
    """

    joints: Floats
    targets: Ints
    drawn: int


def draw_candidates(
    arm: SerialArm,
    rules: Rules,
    count: int,
    seed: int,
    progress: Callable[[int, int], None] | None = None,
) -> Candidates:
    """Draw poses until there are enough that keep the rules.

    Where more targets are seen than are measured, those are that look straightest at the instrument; without an
    instrument's place the targets take turns.

    Args:
        progress: called with the poses found and wanted.

    Raises:
        InsufficientPointsError: hardly any pose keeps them; what refused how many is named.
    """
    low, high = _ranges(arm, rules)
    rng = np.random.default_rng(seed)
    gaps = None if rules.scene is None else Gaps(rules.scene)
    joints: list[Floats] = []
    targets: list[Ints] = []
    found, touching, unseen = 0, 0, 0
    for batch in range(1, _MOST_BATCHES + 1):
        # Of as many digits as a table of poses has: what is judged here is what is driven to.
        poses = np.round(rng.uniform(low, high, (_BATCH, len(low))), DIGITS)
        free = _free(gaps, poses, rules)
        touching += int(np.sum(~free))
        poses = poses[free]
        measured = _measured(arm, poses, rules, found)
        seen = measured[:, 0] >= 0
        unseen += int(np.sum(~seen))
        joints.append(poses[seen])
        targets.append(measured[seen])
        found += int(np.sum(seen))
        if progress is not None:
            progress(min(found, count), count)
        if found >= count:
            return Candidates(np.concatenate(joints)[:count], np.concatenate(targets)[:count], batch * _BATCH)
    raise InsufficientPointsError(
        f"of {_MOST_BATCHES * _BATCH} random poses {found} may be chosen, {count} are wanted: at {touching} bodies "
        f"come too near, at {unseen} the instrument sees no target. Move the instrument, widen the cone, or ask "
        "for fewer candidates"
    )


def _ranges(arm: SerialArm, rules: Rules) -> tuple[Floats, Floats]:
    """Return the ends of what a pose may have; each joint has to come from below."""
    own_low, own_high = ranges_of(arm.chain)
    low = own_low if rules.low is None else np.maximum(rules.low, own_low)
    high = own_high if rules.high is None else np.minimum(rules.high, own_high)
    low = np.maximum(low, own_low + rules.approach)
    narrow = [name for name, one, other in zip(arm.joint_names, low, high, strict=True) if one >= other]
    if narrow:
        raise InsufficientPointsError(
            f"{narrow[0]} has no range left for an approach from {rules.approach:g} below: widen its limits"
        )
    return low, high


def _free(gaps: Gaps | None, poses: Floats, rules: Rules) -> Bools:
    """Return where no bodies touch, at the pose and where its approach begins, shape (n,)."""
    if gaps is None:
        return np.ones(len(poses), dtype=np.bool_)
    both = np.concatenate([gaps.at(poses), gaps.at(poses - rules.approach)])
    least = both.min(axis=0, initial=np.inf)
    return np.asarray(least >= rules.gap_mm)


def _measured(arm: SerialArm, poses: Floats, rules: Rules, before: int) -> Ints:
    """Return the targets that are measured at each pose, −1 behind the last, shape (n, most)."""
    count, most = len(arm.targets), min(rules.targets_per_pose, len(arm.targets))
    if rules.sight is None:
        first = before + np.arange(len(poses))
        return np.asarray((first[:, None] + np.arange(most)) % count)
    targets = [
        Sighted(target.place_mm, normal)
        for target, normal in zip(arm.targets, rules.sight.normals, strict=True)
    ]
    return straightest(sight_angles_deg(rules.sight.view, arm.chain, poses, targets), most)
