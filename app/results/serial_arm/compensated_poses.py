"""Compensated commands of a serial arm as CSV, as a RAPID module and as a KRL module."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Final, Literal, TypeAlias

import numpy as np

from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.files.csv_text import csv_text
from catseye.app.files.poses import NamedPoses, poses_table, read_poses
from catseye.app.results.serial_arm.identified_arm import IdentifiedArm
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.compensation import Compensated
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
    """

    poses: NamedPoses
    found: Compensated
    units: tuple[Unit, ...]

    @property
    def kept(self) -> list[int]:
        """Numbers of the poses that have a command."""
        refused = {one.row for one in self.found.refused}
        return [row for row in range(len(self.poses.names)) if row not in refused]

    def refusals(self) -> list[str]:
        """Return a sentence for each pose without a command."""
        return [f"pose {self.poses.names[one.row]}: {one.reason}" for one in self.found.refused]


def compensate_poses(arm: IdentifiedArm, path: Path, target: str | None) -> CompensatedPoses:
    """Compensate the poses of a CSV.

    Args:
        target: of the tool, the place that is to be right; the flange without one.

    Raises:
        UsageError: the file is missing or wrong, or the tool has no such target.
        MeasurementRejectedError: no pose can be compensated.
    """
    units = tuple(joint.unit for joint in arm.arm.chain.joints)
    poses = read_poses(path, poses_table(units))
    found = CompensatedPoses(poses, arm.compensated(poses.joints, target), units)
    if not found.kept:
        raise MeasurementRejectedError(f"{path}: no pose can be compensated: {found.refusals()[0]}")
    return found


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
    names = _names(compensated)
    joints = compensated.found.joints[compensated.kept]
    return (_rapid if form == "rapid" else _krl)(names, joints, list(header))


def _csv(compensated: CompensatedPoses) -> str:
    poses, found = compensated.poses, compensated.found
    joints = (column.name for column in poses_table(compensated.units).forms[0])
    header = ["pose", *joints, "uncorrected_mm", "reason"]
    reasons = {one.row: one.reason for one in found.refused}
    body = (
        [
            name,
            *("" if np.isnan(q) else f"{q:.6f}" for q in found.joints[row]),
            f"{found.uncorrected_mm[row]:.4f}",
            reasons.get(row, ""),
        ]
        for row, name in enumerate(poses.names)
    )
    return csv_text(header, body)


def _names(compensated: CompensatedPoses) -> list[str]:
    """Return names that a controller takes: letters, digits and underscores, each once."""
    found: list[str] = []
    for number, row in enumerate(compensated.kept, 1):
        plain = _NOT_IN_A_NAME.sub("_", compensated.poses.names[row])
        name = f"p{number}_{plain}"[:_LONGEST_NAME]
        found.append(name)
    return found


def _rapid(names: list[str], joints: Floats, header: list[str]) -> str:
    declared = [
        f"  CONST jointtarget {name}:=[[{_listed(q)}],[9E9,9E9,9E9,9E9,9E9,9E9]];"
        for name, q in zip(names, joints, strict=True)
    ]
    moves = [f"    MoveAbsJ {name}\\NoEOffs,v100,fine,tool0;" for name in names]
    remarks = [f"  ! {line}" for line in header]
    return "\r\n".join(
        ["MODULE CATSCOMP", *remarks, *declared, "  PROC catscomp()", *moves, "  ENDPROC", "ENDMODULE", ""]
    )


def _krl(names: list[str], joints: Floats, header: list[str]) -> str:
    axes = [", ".join(f"A{k} {value:.6f}" for k, value in enumerate(q, 1)) for q in joints]
    remarks = [f"; {line}" for line in header]
    moves = [f"; {name}\r\nPTP {{{text}}}" for name, text in zip(names, axes, strict=True)]
    speeds = ["FOR I=1 TO 6", "   $VEL_AXIS[I]=10", "ENDFOR"]
    return "\r\n".join(["DEF CATSCOMP( )", "INT I", *remarks, *speeds, *moves, "END", ""])


def _listed(q: Floats) -> str:
    return ",".join(f"{value:.6f}" for value in q)
