"""Joints that a controller read back, against those that were commanded: mistakes in their columns alone."""

from collections.abc import Iterator, Sequence

import numpy as np
from scipy.optimize import linear_sum_assignment

from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.joint_mistakes import (
    JointMistake,
    in_order,
    in_radians,
    misplaced,
    two_signs,
)

_APART = 1.0
"""deg or mm: a controller reads back what it commanded to some hundredths."""


def read_back_mistake(
    arm: SerialArm, commanded: Floats, read_back: Floats, names: Sequence[str]
) -> str | None:
    """Return what is wrong with the joints read back; None where they are those of the poses.

    A few poses that are wrong alone are no matter of their columns: they are left out later.

    Args:
        commanded: deg or mm, shape (n, joints).
        read_back: shape (n, joints).
        names: of the poses.
    """
    apart = np.median(np.abs(read_back - commanded), axis=0)
    worst = int(np.argmax(apart))
    if apart[worst] <= _APART:
        return None
    unit, remedy = arm.chain.joints[worst].unit, "put the columns q1_read_deg … right, or leave them out"
    differ = (
        f"the joints read back differ from the commanded ones by {apart[worst]:.3g} {unit} "
        f"({arm.joint_names[worst]}, median of the poses)"
    )
    for text, joints in _mistakes(arm, commanded, read_back, names):
        left = float(np.median(np.abs(joints - commanded), axis=0).max())
        if left <= _APART:
            return f"{differ}, and by {left:.3g} at most if {text}: {remedy}"
    return f"{differ}: they are not those of these poses, or not of these joints; {remedy}"


def other_poses(arm: SerialArm, commanded: Floats, read_back: Floats, names: Sequence[str]) -> str | None:
    """Return what is remarked of single poses whose joints read back are others; None where there are none.

    Args:
        commanded: deg or mm, shape (n, joints).
        read_back: shape (n, joints).
        names: of the poses.
    """
    apart = np.abs(read_back - commanded)
    others = (apart > _APART).any(axis=1)
    if not others.any():
        return None
    first = int(np.argmax(others))
    joint = int(np.argmax(apart[first]))
    zeros = "" if read_back[others].any() else ", all of them 0 there"
    return (
        f"the joints read back at {np.count_nonzero(others)} of {len(names)} poses differ from the commanded ones by "
        f"more than {_APART:g} deg or mm{zeros} (the first: pose {names[first]!r}, {arm.joint_names[joint]} by "
        f"{apart[first, joint]:.3g}): correct these rows, or leave the columns q1_read_deg … out"
    )


def _whole_turns(arm: SerialArm, commanded: Floats, read_back: Floats) -> Iterator[JointMistake]:
    """Give the joints without whole turns: other turns of the last axis, or angles wrapped to ±180°."""
    revolute = np.array([one.kind == "revolute" for one in arm.chain.joints])
    turns: Floats = np.where(revolute, np.round((read_back - commanded) / 360.0), 0.0)
    turned = [arm.joint_names[k] for k in np.flatnonzero(np.abs(turns).max(axis=0))]
    if turned:
        yield (
            f"{', '.join(turned)} {'is' if len(turned) == 1 else 'are'} whole turns away",
            read_back - 360.0 * turns,
        )


def _mistakes(
    arm: SerialArm, commanded: Floats, read_back: Floats, names: Sequence[str]
) -> Iterator[JointMistake]:
    yield from _whole_turns(arm, commanded, read_back)
    yield from in_radians(arm, read_back, names)
    yield from misplaced(arm, read_back)
    yield from two_signs(arm, read_back)
    cost = np.median(np.abs(commanded[:, :, None] - read_back[:, None, :]), axis=0)
    yield in_order(arm, read_back, linear_sum_assignment(cost)[1].tolist())
