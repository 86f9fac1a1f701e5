"""Poses that may be chosen: drawn within the joints' ranges, kept where no bodies meet and a target is seen.

Visibility: a retroreflector is seen within a cone about the direction in which it looks, and no body of the arm
stands in the line of sight.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from catseye.calibration.core.errors import InsufficientPointsError
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.kinematics.bodies import Capsule, Gaps, Point, Scene
from catseye.calibration.kinematics.distances import segment_to_segment_mm
from catseye.calibration.kinematics.joint_ranges import ranges_of
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import ModelName, parameters_of, tell_apart
from catseye.calibration.serial_arm.measurements import MeasuredPoints, Measurements
from catseye.calibration.serial_arm.model import ArmModel

_BATCH = 5000
_MOST_BATCHES = 200


@dataclass(frozen=True)
class Sight:
    """An instrument and what it sees.

    Attributes:
        station_mm: in the frame of the arm's base.
        normals: direction in which each target looks, in the frame of the flange; None of one seen from everywhere.
        cone_deg: half angle within which a target is seen.
    """

    station_mm: Point
    normals: tuple[Point | None, ...]
    cone_deg: float = 30.0


@dataclass(frozen=True)
class Rules:
    """What a pose has to keep.

    Attributes:
        bodies: of the arm, in their frames.
        sight: None where the instrument follows the target everywhere.
        approach: by how much below the pose each joint begins its last move, deg or mm.
        gap_mm: that bodies keep from each other.
        low: smallest joints, deg or mm, shape (joints,); None: those of the arm.
        high: largest.
    """

    bodies: tuple[Capsule, ...] = ()
    sight: Sight | None = None
    approach: float = 5.0
    gap_mm: float = 10.0
    low: Floats | None = None
    high: Floats | None = None


@dataclass(frozen=True)
class Candidates:
    """Poses that keep the rules.

    Attributes:
        joints: deg or mm, shape (n, joints).
        target: number of the target that is measured at each, shape (n,).
        drawn: poses that were tried.
    """

    joints: Floats
    target: Ints
    drawn: int


def draw_candidates(
    arm: SerialArm,
    rules: Rules,
    count: int,
    seed: int,
    progress: Callable[[int, int], None] | None = None,
) -> Candidates:
    """Draw poses until there are enough that keep the rules.

    Where several targets are seen, the one that looks straightest at the instrument is measured; without an
    instrument's place the targets take turns.

    Args:
        progress: called with the poses found and wanted.

    Raises:
        InsufficientPointsError: hardly any pose keeps them; what refused how many is named.
    """
    low, high = _ranges(arm, rules)
    rng = np.random.default_rng(seed)
    gaps = Gaps(Scene(arm.chain, rules.bodies)) if rules.bodies else None
    joints: list[Floats] = []
    targets: list[Ints] = []
    found, touching, unseen = 0, 0, 0
    for batch in range(1, _MOST_BATCHES + 1):
        poses = rng.uniform(low, high, (_BATCH, len(low)))
        free = _free(gaps, poses, rules)
        touching += int(np.sum(~free))
        poses = poses[free]
        target, seen = _seen(arm, poses, rules, found)
        unseen += int(np.sum(~seen))
        joints.append(poses[seen])
        targets.append(target[seen])
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


def information_rows(
    arm: SerialArm, candidates: Candidates, name: ModelName
) -> tuple[Floats, tuple[str, ...]]:
    """Return what each candidate says of the parameters of a model, and their names.

    Returns:
        Derivatives of the target's place, mm per unit, shape (candidates, 3, parameters), and the names of the
        parameters that such measurements tell apart.
    """
    count = len(candidates.joints)
    points = MeasuredPoints(np.arange(count), candidates.target, np.zeros((count, 3)))
    rows = Measurements(Commands.of(arm, candidates.joints), tuple(map(str, range(count))), points)
    model = ArmModel(arm, np.eye(4), parameters_of(arm, rows, name), rows)
    kept = tell_apart(model).kept
    chosen = tuple(model.chosen[k] for k in kept)
    values = np.array([one.nominal for one in model.chosen])
    jacobian = model.jacobian(values)[: 3 * count, kept]
    return jacobian.reshape(count, 3, -1), tuple(one.name for one in chosen)


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


def _seen(arm: SerialArm, poses: Floats, rules: Rules, before: int) -> tuple[Ints, Bools]:
    """Return the target that is measured at each pose, and whether there is one, shape (n,) each."""
    count = len(arm.targets)
    if rules.sight is None:
        return (before + np.arange(len(poses))) % count, np.ones(len(poses), dtype=np.bool_)
    frames = arm.chain.frames(poses)
    straight = np.stack(
        [_straightness(arm, frames, rules, rules.sight, number) for number in range(count)], axis=-1
    )
    return np.argmax(straight, axis=1), np.asarray(straight.max(axis=1) > -np.inf)


def _straightness(arm: SerialArm, frames: Floats, rules: Rules, sight: Sight, number: int) -> Floats:
    """Return the cosine between where a target looks and the instrument; −∞ where it is not seen, shape (n,)."""
    flange, normal = frames[-1], sight.normals[number]
    place = flange[:, :3, :3] @ np.array(arm.targets[number].place_mm) + flange[:, :3, 3]
    beam = np.array(sight.station_mm) - place
    beam_length = np.linalg.norm(beam, axis=1)
    if normal is None:
        cosine = np.ones(len(place))
    else:
        looks = flange[:, :3, :3] @ (np.array(normal) / np.linalg.norm(normal))
        cosine = np.einsum("ni,ni->n", looks, beam) / np.maximum(beam_length, 1e-9)
    hidden = cosine < np.cos(np.deg2rad(sight.cone_deg)) if normal is not None else np.zeros(len(place), bool)
    hidden |= _in_the_way(frames, place, np.array(sight.station_mm), rules.bodies)
    return np.where(hidden, -np.inf, cosine)


def _in_the_way(frames: Floats, place: Floats, station: Floats, bodies: Sequence[Capsule]) -> Bools:
    """Return where a body of the arm stands between a target and the instrument, shape (n,)."""
    found = np.zeros(len(place), dtype=np.bool_)
    for body in bodies:
        frame = frames[body.frame]
        start, end = (
            frame[:, :3, :3] @ np.array(point) + frame[:, :3, 3] for point in (body.start_mm, body.end_mm)
        )
        apart = segment_to_segment_mm(place, np.broadcast_to(station, place.shape), start, end)
        # A nest is mounted on its body: that one does not hide it by holding it.
        own = segment_to_segment_mm(place, place, start, end) <= body.radius_mm
        found |= (apart < body.radius_mm) & ~own
    return found
