"""Poses CSV: commanded joints of poses, one name each."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.files.columns import read_rows
from catseye.calibration.core.types import Floats
from catseye.drivers.roles.pose import Unit
from catseye.procedures.kit.columns import ColumnRule, TableRule


@dataclass(frozen=True)
class NamedPoses:
    """Poses in the order of their file.

    Attributes:
        names: each once.
        joints: deg or mm, shape (n, joints).
        lines: of the file, where each begins.
        rows: number of each, one a target.
        targets: that the file names of each, each once; empty where it names none.
    """

    names: tuple[str, ...]
    joints: Floats
    lines: tuple[int, ...]
    rows: tuple[int, ...]
    targets: tuple[tuple[str, ...], ...] = ()


def poses_table(units: Sequence[Unit]) -> TableRule:
    """Return what a file of poses may hold: `q1_deg` … of an arm with joints of these units."""
    form = tuple(ColumnRule(f"q{number}_{unit}", unit=unit) for number, unit in enumerate(units, 1))
    names = ",".join(column.name for column in form)
    return TableRule(
        "poses", "a pose and its joints", (form,), source=f"a file with the columns pose,{names}"
    )


def read_poses(path: Path, rule: TableRule) -> NamedPoses:
    """Read poses; further columns, as measured files have them, are passed over.

    Args:
        rule: of the joints' columns, in one form.

    Raises:
        UsageError: the file is missing, a column is missing, a value is wrong, or rows of one pose have other joints;
            names file and line.
    """
    rows, columns = read_rows(path, rule)
    if "pose" not in rows[0].cells:
        raise UsageError(f"{path}: column pose is missing: it takes {rule.source}")
    joints = columns.stacked([column.name for column in rule.forms[0]])
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
    kept, counts = list(first.values()), Counter(row.cells["pose"] for row in rows)
    return NamedPoses(
        tuple(first),
        joints[kept],
        tuple(rows[number].line for number in kept),
        tuple(counts[name] for name in first),
        targets=tuple(tuple(targets[name]) for name in first),
    )
