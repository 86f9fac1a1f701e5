"""Poses CSV: commanded joints of poses, one name each."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.files.columns import read_rows
from catseye.calibration.core.types import Floats
from catseye.drivers.roles.pose import Unit
from catseye.procedures.kit.columns import ColumnRule, Columns, TableRule


@dataclass(frozen=True)
class NamedPoses:
    """Poses in the order of their file.

    Attributes:
        names: each once.
        joints: deg or mm, shape (n, joints).
        lines: of the file, where each begins.
        rows: number of each, one a target.
        targets: that the file names of each, each once; empty where it names none.
        sides: that each joint comes from, 1 from below, −1 from above, shape (n, joints); None where the file does
            not say.
    """

    names: tuple[str, ...]
    joints: Floats
    lines: tuple[int, ...]
    rows: tuple[int, ...]
    targets: tuple[tuple[str, ...], ...] = ()
    sides: Floats | None = None


def poses_table(units: Sequence[Unit]) -> TableRule:
    """Return what a file of poses may hold: `q1_deg` … of an arm with joints of these units."""
    form = tuple(ColumnRule(f"q{number}_{unit}", unit=unit) for number, unit in enumerate(units, 1))
    names = ",".join(column.name for column in form)
    return TableRule(
        "poses", "a pose and its joints", (form,), source=f"a file with the columns pose,{names}"
    )


def read_poses(path: Path, rule: TableRule) -> NamedPoses:
    """Read poses, with the sides that their joints come from; further columns of measured files are passed over.

    Args:
        rule: of the joints' columns, in one form.

    Raises:
        UsageError: the file is missing, a column is missing, a value is wrong, or rows of one pose have other joints
            or sides; names file and line.
    """
    (form,) = rule.forms
    rows, columns = read_rows(path, replace(rule, forms=((*form, *side_columns(len(form))),)))
    if "pose" not in rows[0].cells:
        raise UsageError(f"{path}: column pose is missing: it takes {rule.source}")
    joints = columns.stacked([column.name for column in form])
    sides = sides_among(path, columns, len(form))
    first: dict[str, int] = {}
    targets: dict[str, dict[str, None]] = {}
    for number, row in enumerate(rows):
        name = row.cells["pose"]
        if not name:
            raise row.fault("the pose has no name: state one in the column pose")
        if (joints[first.setdefault(name, number)] != joints[number]).any():
            raise row.fault(
                f"pose {name!r} has other joints on line {rows[first[name]].line}: give each pose its own name"
            )
        own = targets.setdefault(name, {})
        own |= dict.fromkeys(filter(None, [row.cells.get("target", "")]))
        if sides is not None and (sides[first[name]] != sides[number]).any():
            raise row.fault(
                f"pose {name!r} comes from other sides on line {rows[first[name]].line}: give each pose its own "
                "name, or correct the directions"
            )
    kept, counts = list(first.values()), Counter(row.cells["pose"] for row in rows)
    return NamedPoses(
        tuple(first),
        joints[kept],
        tuple(rows[number].line for number in kept),
        tuple(counts[name] for name in first),
        tuple(tuple(targets[name]) for name in first),
        None if sides is None else sides[kept],
    )


def require_from_below(path: Path, poses: NamedPoses) -> None:
    """Refuse poses that some joint comes to from above.

    Raises:
        UsageError: names file, line and column.
    """
    if poses.sides is None:
        return
    for name, line, sides in zip(poses.names, poses.lines, poses.sides.tolist(), strict=True):
        if -1.0 in sides:
            column = side_names(len(sides))[sides.index(-1.0)]
            raise UsageError(
                f"{path}:{line}: pose {name!r} has {column} = -1, and a run brings every axis to its pose from below "
                "(approach_deg): leave the columns direction1 … out, or state 1"
            )


def side_names(joints: int) -> list[str]:
    """Return the columns that say from which side each joint comes."""
    return [f"direction{number}" for number in range(1, joints + 1)]


def side_columns(joints: int) -> tuple[ColumnRule, ...]:
    """Return the rules of these columns."""
    return tuple(ColumnRule(name, "direction", optional=True) for name in side_names(joints))


def sides_among(path: Path, columns: Columns, joints: int) -> Floats | None:
    """Return from which side each joint comes, 1 from below, −1 from above, shape (rows, joints); None: not stated.

    Raises:
        UsageError: the file has some of the columns only.
    """
    return all_or_none(path, columns, side_names(joints), "directions of approach")


def all_or_none(path: Path, columns: Columns, names: Sequence[str], what: str) -> Floats | None:
    """Return columns that belong together, shape (rows, columns); None where the file has none of them.

    Raises:
        UsageError: it has some of them only.
    """
    here = [name in columns for name in names]
    if any(here) and not all(here):
        raise UsageError(f"{path}: column {names[here.index(False)]} is missing: {what} are all or none")
    return columns.stacked(names) if all(here) else None
