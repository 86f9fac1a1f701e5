"""Measured poses as CSV: joints, and what an instrument said of the targets there (docs/files.md).

One row is one measured target; rows of one pose share its name. A file has places of targets, with the orientation of
a frame where it was measured, or distances from targets to anchors.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.cell.arm import ArmDescription
from catseye.app.errors import UsageError
from catseye.app.files.columns import read_rows
from catseye.app.files.csv_lines import CsvRow
from catseye.app.files.poses import all_or_none, side_columns, sides_among
from catseye.app.results.serial_arm.nominal_arm import FLANGE, with_flange, with_unknown_targets
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.kinematics.rotations import rotation_of
from catseye.calibration.serial_arm.arm import Anchor, SerialArm
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.measurements import (
    MeasuredDistances,
    MeasuredOrientations,
    MeasuredPoints,
    Measurements,
)
from catseye.calibration.serial_arm.several_tables import Tables
from catseye.drivers.roles.pose import Unit
from catseye.procedures.kit.columns import ColumnRule, Columns, TableRule

_PLACE: Final = ("x_mm", "y_mm", "z_mm")
_ANGLES: Final = ("rx_deg", "ry_deg", "rz_deg")
_U_EACH: Final = ("u_x_mm", "u_y_mm", "u_z_mm")
_COVARIANCES: Final = {"cov_xy_mm2": (0, 1), "cov_xz_mm2": (0, 2), "cov_yz_mm2": (1, 2)}
_STATED: Final = ("u_mm", *_U_EACH, *_COVARIANCES, "u_deg")

_FARTHEST_MM: Final = 1e6
"""A kilometre: no instrument of this trade measures farther."""

_TOO_FAR: Final = "check the unit, or leave the row out"

_READ_ALIKE: Final = 0.01
"""deg or mm: read-back joints of an arm at standstill scatter by less from target to target; their mean is taken."""


@dataclass(frozen=True)
class MeasuredPoses:
    """Tables of measured poses.

    Attributes:
        arm: nominal arm with the targets that the tables name.
        measurements: with the commanded joints.
        read_back: joints as the controller said them, deg or mm, shape (n, joints); None where a table has none.
        tables: that the rows are from.
    """

    arm: SerialArm
    measurements: Measurements
    read_back: Floats | None
    tables: Tables


def read_measured_poses(
    paths: Sequence[Path], description: ArmDescription, nominal: SerialArm, anchors: Mapping[str, Anchor]
) -> MeasuredPoses:
    """Read tables of one arm.

    Args:
        nominal: the arm with the targets of its tool; without any the places of the targets are unknown.
        anchors: known beforehand, by name.

    Raises:
        UsageError: a file is missing or given twice, a column is missing, a value is wrong, a name is unknown, or
            rows of one pose have other joints; names file and line.
    """
    places = [path.resolve() for path in paths]
    if twice := [path for path, place in zip(paths, places, strict=True) if places.count(place) > 1]:
        raise UsageError(f"{twice[0]} is given twice: its rows would count as two measurements; give it once")
    units = [joint.unit for joint in description.joint]
    tables = [_Table.read(path, units) for path in paths]
    poses = _Poses.of(tables)
    _require_stated_alike(tables)
    arm, targets = _targets(tables, nominal)
    names = sorted({row.cells["anchor"] for table in tables if table.distances for row in table.rows})
    known = tuple(anchors.get(name, Anchor(name, u_mm=None)) for name in names)
    first = Commands.of(arm, poses.joints, poses.approach)
    found = Measurements(
        first,
        poses.names,
        _points(tables, poses, targets),
        _orientations(tables, poses, targets),
        _distances(tables, poses, targets, known),
    )
    return MeasuredPoses(arm, found, poses.read_back, _numbers_of(tables))


def _numbers_of(tables: Sequence["_Table"]) -> Tables:
    numbers = np.repeat(np.arange(len(tables)), [len(table.rows) for table in tables])
    of_distances = np.repeat([table.distances for table in tables], [len(table.rows) for table in tables])
    return Tables(numbers[~of_distances], numbers[of_distances])


@dataclass(frozen=True)
class _Table:
    """One file.

    Attributes:
        joints: commanded, shape (rows, joints).
        read_back: shape (rows, joints); None where the file has none.
        approach: side that each joint came from, 1 from below, −1 from above, shape (rows, joints).
    """

    rows: list[CsvRow]
    columns: Columns
    joints: Floats
    read_back: Floats | None
    approach: Floats

    @classmethod
    def read(cls, path: Path, units: Sequence[Unit]) -> "_Table":
        rows, columns = read_rows(path, measured_table(units))
        wanted = ("pose", "target", "anchor", "segment") if "distance_mm" in columns else ("pose", "target")
        missing = [name for name in wanted if name not in rows[0].cells]
        if missing:
            raise UsageError(
                f"{path}: column {', '.join(missing)} is missing: each row names its {wanted[0]} and more"
            )
        joints = columns.stacked([f"q{k}_{unit}" for k, unit in enumerate(units, 1)])
        read = all_or_none(
            path, columns, [f"q{k}_read_{unit}" for k, unit in enumerate(units, 1)], "read-back joints"
        )
        all_or_none(path, columns, list(_COVARIANCES), "covariances")
        sides = sides_among(path, columns, len(units))
        return cls(rows, columns, joints, read, np.ones_like(joints) if sides is None else sides)

    @property
    def distances(self) -> bool:
        """It holds distances."""
        return "distance_mm" in self.columns

    @property
    def turned(self) -> bool:
        """It holds orientations."""
        return all(name in self.columns for name in _ANGLES)

    @property
    def stated(self) -> bool:
        """It states uncertainties of everything that it holds."""
        places = "u_mm" in self.columns or all(name in self.columns for name in _U_EACH)
        return places and (not self.turned or "u_deg" in self.columns)


def _require_stated_alike(tables: Sequence[_Table]) -> None:
    """Refuse tables of which some rows state an uncertainty and others none: nobody could weigh them."""
    partly = [one for one in tables if not one.stated and any(name in one.columns for name in _STATED)]
    bare = [one for one in tables if not one.stated]
    if partly or (bare and len(bare) < len(tables)):
        path = (partly or bare)[0].rows[0].path
        raise UsageError(
            f"{path}: uncertainties are stated for some rows only: state u_mm (or u_x_mm, u_y_mm, u_z_mm), and u_deg "
            "where angles were measured, in every table, or nowhere"
        )


def measured_table(units: Sequence[Unit]) -> TableRule:
    """Return what a file of measured poses may hold, of an arm with joints of these units."""
    joints = tuple(ColumnRule(f"q{k}_{unit}", unit=unit) for k, unit in enumerate(units, 1))
    read = tuple(ColumnRule(f"q{k}_read_{unit}", unit=unit, optional=True) for k, unit in enumerate(units, 1))
    u_mm = ColumnRule("u_mm", unit="mm", optional=True, positive=True)
    place = tuple(ColumnRule(name, unit="mm", largest=_FARTHEST_MM, hint=_TOO_FAR) for name in _PLACE)
    angles = tuple(ColumnRule(name, unit="deg", optional=True) for name in _ANGLES)
    u_each = tuple(ColumnRule(name, unit="mm", optional=True, positive=True) for name in _U_EACH)
    covariances = tuple(ColumnRule(name, unit="mm²", optional=True) for name in _COVARIANCES)
    u_deg = ColumnRule("u_deg", unit="deg", optional=True, positive=True)
    distance = ColumnRule("distance_mm", unit="mm", largest=_FARTHEST_MM, hint=_TOO_FAR)
    read = (*read, *side_columns(len(units)))
    return TableRule(
        "measured poses",
        "one measured target of a pose",
        (
            (*joints, *read, distance, u_mm),
            (*joints, *read, *place, u_mm, *u_each, *covariances, *angles, u_deg),
        ),
        mixed="places and distances stand in one file: give each a file of its own (--poses twice)",
        source="a file with the columns pose, "
        + ", ".join(column.name for column in joints)
        + ", target and x_mm, y_mm, z_mm, or target, anchor, segment and distance_mm",
    )


@dataclass(frozen=True)
class _Poses:
    """The poses of all tables, each once.

    Attributes:
        numbers: of the pose of each row, one array a table.
    """

    names: tuple[str, ...]
    joints: Floats
    read_back: Floats | None
    approach: Floats
    numbers: tuple[Ints, ...]

    @classmethod
    def of(cls, tables: Sequence[_Table]) -> "_Poses":
        """Gather the rows of each pose.

        Raises:
            UsageError: a pose has no name, or its rows contradict each other; names both lines.
        """
        poses: dict[str, _Pose] = {}
        numbers: list[Ints] = []
        for table in tables:
            found = []
            for k, row in enumerate(table.rows):
                name = row.cells["pose"]
                if not name:
                    raise row.fault("the pose has no name: state one in the column pose")
                if name not in poses:
                    poses[name] = _Pose(len(poses), row, table.joints[k], table.approach[k])
                poses[name].take(name, table, k)
                found.append(poses[name].number)
            numbers.append(np.array(found, dtype=np.int64))
        all_poses = list(poses.values())
        read = [np.mean(one.read_back, axis=0) for one in all_poses if one.read_back]
        return cls(
            tuple(poses),
            np.array([one.joints for one in all_poses]),
            np.array(read) if len(read) == len(all_poses) else None,
            np.array([one.approach for one in all_poses]),
            tuple(numbers),
        )


@dataclass
class _Pose:
    """What the rows of one pose say of the joints; they have to agree.

    Attributes:
        number: of the pose.
        where: its first row.
        read_back: of each row that has it.
    """

    number: int
    where: CsvRow
    joints: Floats
    approach: Floats
    read_back: list[Floats] = field(default_factory=list)

    def take(self, name: str, table: _Table, k: int) -> None:
        """Take a row of the pose.

        Raises:
            UsageError: it contradicts the rows before.
        """
        row, other = table.rows[k], f"{self.where.path}:{self.where.line}"
        if (self.joints != table.joints[k]).any():
            raise row.fault(f"pose {name!r} has other joints in {other}: give each pose its own name")
        if (self.approach != table.approach[k]).any():
            raise row.fault(
                f"pose {name!r} was approached from other sides in {other}: an arm that came twice stood at two "
                "poses; give each its own name, or correct the directions"
            )
        if table.read_back is None:
            return
        read = table.read_back[k]
        if self.read_back and (apart := float(np.abs(self.read_back[0] - read).max())) > _READ_ALIKE:
            raise row.fault(
                f"pose {name!r} has read-back joints in {other} that differ by {apart:.4g} (more than "
                f"{_READ_ALIKE:g} deg or mm): the arm did not stand still between the rows; give each "
                "pose its own name"
            )
        self.read_back.append(read)


def _targets(tables: Sequence[_Table], nominal: SerialArm) -> tuple[SerialArm, tuple[Ints, ...]]:
    """Return the arm with its targets, and the number of each row's target, one array a table."""
    names = [[row.cells["target"] or FLANGE for row in table.rows] for table in tables]
    used = sorted({name for of_table in names for name in of_table})
    turned = {name for table, own in zip(tables, names, strict=True) if table.turned for name in own}
    arm = (
        nominal if nominal.targets else with_unknown_targets(nominal, [one for one in used if one != FLANGE])
    )
    targets = [replace(one, turned=one.name in turned and one.name != FLANGE) for one in arm.targets]
    arm = arm.with_targets(tuple(targets))
    arm = with_flange(arm) if FLANGE in used else arm
    known = [target.name for target in arm.targets]
    for table, of_table in zip(tables, names, strict=True):
        for row, name in zip(table.rows, of_table, strict=True):
            if name not in known:
                raise row.fault(
                    f"the tool has no target {name!r}; it has {', '.join(known)}: correct the name, here or in the "
                    "tool's file"
                )
    numbers = tuple(np.array([known.index(name) for name in of_table]) for of_table in names)
    return arm, numbers


def _points(tables: Sequence[_Table], poses: _Poses, targets: Sequence[Ints]) -> MeasuredPoints:
    used = [k for k, table in enumerate(tables) if not table.distances]
    if not used:
        return MeasuredPoints()
    covariances = [_covariance(tables[k]) for k in used]
    stated = [one for one in covariances if one is not None]
    return MeasuredPoints(
        np.concatenate([poses.numbers[k] for k in used]),
        np.concatenate([targets[k] for k in used]),
        np.concatenate([tables[k].columns.stacked(_PLACE) for k in used]),
        np.concatenate(stated) if len(stated) == len(used) else None,
    )


def _covariance(table: _Table) -> Floats | None:
    """Return the covariances of the places of a table, mm², shape (rows, 3, 3); None where it states none."""
    columns = table.columns
    if all(name in columns for name in _U_EACH):
        variances = columns.stacked(_U_EACH) ** 2
    elif "u_mm" in columns:
        variances = np.repeat(columns["u_mm"][:, None] ** 2, 3, axis=1)
    else:
        return None
    found = variances[:, :, None] * np.eye(3)
    for name, (i, j) in _COVARIANCES.items():
        if name in columns:
            found[:, i, j] = found[:, j, i] = columns[name]
    least = np.linalg.eigvalsh(found)[:, 0]
    if least.min() <= 0.0:
        raise table.rows[int(np.argmin(least))].fault(
            "uncertainties and covariances do not fit: no errors of three coordinates can have them"
        )
    return found


def _orientations(tables: Sequence[_Table], poses: _Poses, targets: Sequence[Ints]) -> MeasuredOrientations:
    used = [k for k, table in enumerate(tables) if table.turned]
    if not used:
        return MeasuredOrientations()
    stated = [tables[k].columns["u_deg"] for k in used if "u_deg" in tables[k].columns]
    return MeasuredOrientations(
        np.concatenate([poses.numbers[k] for k in used]),
        np.concatenate([targets[k] for k in used]),
        rotation_of(np.concatenate([tables[k].columns.stacked(_ANGLES) for k in used])),
        np.concatenate(stated) if len(stated) == len(used) else None,
    )


def _distances(
    tables: Sequence[_Table], poses: _Poses, targets: Sequence[Ints], anchors: tuple[Anchor, ...]
) -> MeasuredDistances:
    used = [k for k, table in enumerate(tables) if table.distances]
    if not used:
        return MeasuredDistances()
    rows = [row for k in used for row in tables[k].rows]
    places = {anchor.name: number for number, anchor in enumerate(anchors)}
    labels = [(row.cells["anchor"], row.cells["segment"]) for row in rows]
    segments = list(dict.fromkeys(label for label in labels if label[1]))
    stated = [tables[k].columns["u_mm"] for k in used if "u_mm" in tables[k].columns]
    return MeasuredDistances(
        np.concatenate([poses.numbers[k] for k in used]),
        np.concatenate([targets[k] for k in used]),
        np.array([places[anchor] for anchor, _ in labels]),
        np.array([segments.index(label) if label[1] else -1 for label in labels]),
        np.concatenate([tables[k].columns["distance_mm"] for k in used]),
        np.concatenate(stated) if len(stated) == len(used) else None,
        anchors,
        tuple(f"{anchor}#{segment}" for anchor, segment in segments),
    )
