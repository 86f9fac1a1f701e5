"""Mistakes that are made together, tried where no single one explains the measurements."""

from collections.abc import Iterator
from itertools import permutations

import numpy as np

from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.joint_mistakes import in_order, two_signs
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.misfit import misfit_mm
from catseye.calibration.serial_arm.mistakes import LENGTHS_MM, Mistake, mirrored, moved, scaled

_MOST_JOINTS = 6
"""All orders of more joints are too many to try."""

_POSES = 30
"""So many poses tell which order of the joints is the best one."""


def combined_mistakes(arm: SerialArm, rows: Measurements) -> Iterator[Mistake]:
    """Give mistakes that several single ones make up."""
    if len(rows.points.pose):
        for unit, mm in LENGTHS_MM.items():
            yield Mistake(
                f"the coordinates are in {unit}, not in mm, and the frame of the instrument is left-handed",
                mirrored(scaled(rows, mm)),
            )
    for text, joints in two_signs(arm, rows.commands.joints):
        yield Mistake(text, moved(arm, rows, joints))


def other_order(arm: SerialArm, rows: Measurements) -> Iterator[Mistake]:
    """Give the order of the joints that fits a few poses best; a length takes no place of an angle."""
    if len(arm.joint_names) > _MOST_JOINTS:
        return
    joints, kinds = rows.commands.joints, [joint.kind for joint in arm.chain.joints]
    measured = np.unique(rows.poses)
    kept = np.zeros(len(rows.commands), dtype=np.bool_)
    kept[measured[np.linspace(0, len(measured) - 1, min(_POSES, len(measured))).astype(np.int64)]] = True
    few = rows.at(kept)
    orders = [order for order in permutations(range(len(kinds))) if [kinds[k] for k in order] == kinds]
    best = min(orders, key=lambda order: misfit_mm(arm, moved(arm, few, joints[:, order])))
    text, ordered = in_order(arm, joints, best)
    yield Mistake(text, moved(arm, rows, ordered))
