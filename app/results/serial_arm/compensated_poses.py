"""Compensated commands of a serial arm as CSV, as a RAPID module and as a KRL module."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, TypeAlias

import numpy as np

from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.files.csv_text import csv_text
from catseye.app.files.poses import NamedPoses, poses_table, read_poses, side_names
from catseye.app.results.serial_arm.controller_modules import Move, krl_module, rapid_module
from catseye.app.results.serial_arm.identified_arm import IdentifiedArm
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.compensation import Compensated, with_approach
from catseye.drivers.roles.pose import Unit

Form: TypeAlias = Literal["csv", "rapid", "krl"]

_NOT_IN_A_NAME: Final = re.compile(r"[^A-Za-z0-9_]")
_LONGEST_NAME: Final = 24
"""Characters: both controllers take names of up to 24 at least (RAPID 32, KRL 24)."""

_SIX: Final = 6


@dataclass(frozen=True)
class CompensatedPoses:
    """Poses of a program with the commands that stand in for them.

    Attributes:
        poses: of the program.
        found: commands, NaN where one is refused.
        units: of the joints.
        approach: deg or mm by which the pose that each one is driven from lies on its side, 0 where none is written.
    """

    poses: NamedPoses
    found: Compensated
    units: tuple[Unit, ...]
    approach: float = 0.0

    @property
    def kept(self) -> list[int]:
        """Numbers of the poses that have a command."""
        refused = {one.row for one in self.found.refused}
        return [row for row in range(len(self.poses.names)) if row not in refused]

    @property
    def sides(self) -> Floats:
        """Side that each joint comes from, 1 from below, −1 from above, shape (n, joints)."""
        return sides_of(self.poses)

    def refusals(self) -> list[str]:
        """Return a sentence for each pose without a command."""
        return [f"pose {self.poses.names[one.row]}: {one.reason}" for one in self.found.refused]


def compensate_poses(
    arm: IdentifiedArm, path: Path, target: str | None, approach: float = 0.0
) -> CompensatedPoses:
    """Compensate the poses of a CSV, for the sides that it says the joints come from; from below where it does not.

    Args:
        target: of the tool, the place that is to be right; the flange without one.
        approach: deg or mm on its side from where each pose is to be driven; 0 writes no such poses.

    Raises:
        UsageError: the file is missing or wrong, or the tool has no such target.
        MeasurementRejectedError: no pose can be compensated.
    """
    chain = arm.arm.chain
    units = tuple(joint.unit for joint in chain.joints)
    poses = read_poses(path, poses_table(units))
    sides = sides_of(poses)
    commands = with_approach(chain, arm.compensated(poses.joints, target, sides), sides, approach)
    found = CompensatedPoses(poses, commands, units, approach)
    if not found.kept:
        raise MeasurementRejectedError(f"{path}: no pose can be compensated: {found.refusals()[0]}")
    return found


def sides_of(poses: NamedPoses) -> Floats:
    """Return the side that each joint comes from; from below where nothing is said, shape (n, joints)."""
    return np.ones_like(poses.joints) if poses.sides is None else poses.sides


def compensated_text(compensated: CompensatedPoses, form: Form, header: Iterable[str]) -> str:
    """Return the file of a form.

    Args:
        header: lines that say where the commands come from.

    Raises:
        UsageError: RAPID and KRL have six joints.
    """
    if form == "csv":
        return _csv(compensated)
    if compensated.poses.joints.shape[1] != _SIX:
        raise UsageError(f"--format {form} is for arms of six joints: take --format csv")
    module = rapid_module if form == "rapid" else krl_module
    return module(_moves(compensated), [*header, *_about_sides(compensated)])


def _csv(compensated: CompensatedPoses) -> str:
    poses, found = compensated.poses, compensated.found
    joints = [column.name for column in poses_table(compensated.units).forms[0]]
    header = ["pose", *joints, *side_names(len(joints)), "uncorrected_mm", "reason"]
    reasons = {one.row: one.reason for one in found.refused}
    body = (
        [
            name,
            *("" if np.isnan(q) else f"{q:.6f}" for q in found.joints[row]),
            *(f"{side:.0f}" for side in compensated.sides[row]),
            f"{found.uncorrected_mm[row]:.4f}",
            reasons.get(row, ""),
        ]
        for row, name in enumerate(poses.names)
    )
    return csv_text(header, body)


def _about_sides(compensated: CompensatedPoses) -> list[str]:
    """Return what a module says of the sides that its commands were computed for."""
    side = "below" if _all_below(compensated) else "the side that stands at its pose"
    holds = f"The commands hold where each joint comes from {side}."
    if compensated.approach:
        return [
            holds,
            f"Each pose is driven from {compensated.approach:g} deg on that side of every joint; these paths have "
            "not been checked for obstacles.",
        ]
    return [
        holds,
        "THIS MODULE DOES NOT BRING THEM FROM THERE: drive to each pose from one on that side, "
        "or write the module again with --approach 5.",
    ]


def _all_below(compensated: CompensatedPoses) -> bool:
    return bool((compensated.sides > 0.0).all())


def _moves(compensated: CompensatedPoses) -> list[Move]:
    """Return the moves of a module: each pose, behind the one that it is driven from."""
    moves: list[Move] = []
    for number, row in enumerate(compensated.kept, 1):
        joints, sides = compensated.found.joints[row], compensated.sides[row]
        name = _NOT_IN_A_NAME.sub("_", compensated.poses.names[row])
        if compensated.approach:
            before = joints - compensated.approach * sides
            moves.append(Move(f"a{number}_{name}"[:_LONGEST_NAME], before, "approach"))
        remark = "" if _all_below(compensated) else _sides_text(sides)
        moves.append(Move(f"p{number}_{name}"[:_LONGEST_NAME], joints, remark))
    return moves


def _sides_text(sides: Floats) -> str:
    return ", ".join(
        f"joint {k} from {'below' if side > 0.0 else 'above'}" for k, side in enumerate(sides, 1)
    )
