"""Columns of joints as they would be without a mistake that somebody may have made in them."""

from collections.abc import Iterator, Sequence
from itertools import chain, combinations
from typing import TypeAlias

import numpy as np

from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.arm import SerialArm

TURN_RAD = 2.0 * np.pi
"""Angles of joints that are no larger may be in rad."""

_OTHER_ZEROS = (-90.0, 90.0, 180.0)
"""deg by which conventions put the zero of a joint elsewhere."""

_MOST_SMALL = 6
"""All sets of more joints that may be in rad are too many to try."""

JointMistake: TypeAlias = tuple[str, Floats]
"""Text behind "if", and the joints without the mistake, deg or mm, shape (n, joints)."""


def may_be_radians(joints: Floats) -> bool:
    """Return whether all joints may be in rad."""
    return bool(np.abs(joints).max() <= TURN_RAD)


def in_radians(arm: SerialArm, joints: Floats, names: Sequence[str]) -> Iterator[JointMistake]:
    """Give what may be in rad: all joints, or some of them, or those of some poses.

    Args:
        names: of the poses.
    """
    if may_be_radians(joints):
        yield "the joints are in rad, not in deg", np.rad2deg(joints)
        return
    turns = np.array([one.kind == "revolute" for one in arm.chain.joints])
    small = turns & (np.abs(joints) <= TURN_RAD)
    yield from _some_joints(arm, joints, np.flatnonzero(small.all(axis=0)).tolist())
    poses = small[:, turns].all(axis=1)
    if poses.any():
        first, turned = names[int(np.argmax(poses))], joints.copy()
        turned[np.ix_(poses, turns)] = np.rad2deg(joints[np.ix_(poses, turns)])
        yield (
            f"the joints of {np.count_nonzero(poses)} poses are in rad, not in deg (the first: pose {first!r})",
            turned,
        )


def _some_joints(arm: SerialArm, joints: Floats, numbers: Sequence[int]) -> Iterator[JointMistake]:
    """Give every set of some joints, by their numbers, or each alone and all together where they are many."""
    sizes = range(1, len(numbers) + 1) if len(numbers) <= _MOST_SMALL else (1, len(numbers))
    for chosen in chain.from_iterable(combinations(numbers, size) for size in sizes):
        names = ", ".join(arm.joint_names[k] for k in chosen)
        turned = np.where(np.isin(np.arange(joints.shape[1]), chosen), np.rad2deg(joints), joints)
        yield f"{names} {'is' if len(chosen) == 1 else 'are'} in rad, not in deg", turned


def misplaced(arm: SerialArm, joints: Floats) -> Iterator[JointMistake]:
    """Give other orders, opposite signs, rows of other poses, other zeros."""
    count, names = joints.shape[1], arm.joint_names
    yield "the joints stand in the opposite order", joints[:, ::-1]
    for i, j in combinations(range(count), 2):
        order = list(range(count))
        order[i], order[j] = order[j], order[i]
        yield f"{names[i]} and {names[j]} are exchanged", joints[:, order]
    for i in range(count):
        yield f"{names[i]} has the opposite sign", joints * _signs(count, (i,))
    yield "each row has the joints of the next pose", np.roll(joints, 1, axis=0)
    yield "each row has the joints of the pose before", np.roll(joints, -1, axis=0)
    for i in range(count):
        for zero in _OTHER_ZEROS if arm.chain.joints[i].kind == "revolute" else ():
            shift = np.where(np.arange(count) == i, zero, 0.0)
            yield f"{names[i]} counts from a zero {zero:g} deg away", joints + shift


def two_signs(arm: SerialArm, joints: Floats) -> Iterator[JointMistake]:
    """Give each pair of opposite signs."""
    names = arm.joint_names
    for one, other in combinations(range(len(names)), 2):
        yield (
            f"{names[one]} and {names[other]} have the opposite signs",
            joints * _signs(len(names), (one, other)),
        )


def in_order(arm: SerialArm, joints: Floats, order: Sequence[int]) -> JointMistake:
    """Return joints whose columns stand in an order.

    Args:
        order: number of the column that holds each joint.
    """
    columns = ", ".join(arm.joint_names[list(order).index(column)] for column in range(len(order)))
    return f"the joints stand in the order {columns}", joints[:, list(order)]


def _signs(count: int, opposite: Sequence[int]) -> Floats:
    return np.where(np.isin(np.arange(count), opposite), -1.0, 1.0)
