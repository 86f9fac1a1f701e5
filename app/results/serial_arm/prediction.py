"""Where a calibrated serial arm puts its targets: at the rows of a poses CSV, with uncertainties."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.files.columns import read_rows
from catseye.app.files.csv_lines import CsvRow
from catseye.app.files.csv_text import csv_text
from catseye.app.files.poses import poses_table, side_columns, sides_among
from catseye.app.results.serial_arm.identified_arm import IdentifiedArm
from catseye.app.results.serial_arm.nominal_arm import FLANGE
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.joint_source import JointSource

_OF_PLACES = ("x_pred_mm", "y_pred_mm", "z_pred_mm", "u_pred_mm")
_OF_DISTANCES = ("distance_pred_mm", "u_pred_mm")


@dataclass(frozen=True)
class AskedPlaces:
    """Rows of a poses CSV.

    Attributes:
        target: number of each row's target, shape (n,).
        sided: the file says from which side each joint comes; without it, from below.
    """

    rows: list[CsvRow]
    commands: Commands
    target: Ints
    sided: bool

    @property
    def of_distances(self) -> bool:
        """Distances to anchors are asked for."""
        return "anchor" in self.rows[0].cells


@dataclass(frozen=True)
class Distances:
    """Predicted distances with their standard uncertainties, mm, shape (n,) each."""

    distance_mm: Floats
    u_mm: Floats


@dataclass(frozen=True)
class PredictedPlaces:
    """What the arm makes of them.

    Attributes:
        places_mm: in the frame of the instrument, shape (n, 3).
        covariance_mm2: shape (n, 3, 3).
    """

    asked: AskedPlaces
    places_mm: Floats
    covariance_mm2: Floats

    @property
    def u_mm(self) -> Floats:
        """Standard uncertainty of a coordinate, root mean square of the three, shape (n,)."""
        return np.asarray(np.sqrt(np.trace(self.covariance_mm2, axis1=1, axis2=2) / 3.0))


def read_asked(path: Path, arm: IdentifiedArm) -> AskedPlaces:
    """Read poses, with the target of each row; the column may be missing where the tool has one target only.

    Raises:
        UsageError: the file is missing or wrong, or a target is unknown; names file and line.
    """
    units = [joint.unit for joint in arm.arm.chain.joints]
    (form,) = (table := poses_table(units)).forms
    rows, columns = read_rows(path, replace(table, forms=((*form, *side_columns(len(units))),)))
    joints = columns.stacked([column.name for column in form])
    sides = sides_among(path, columns, len(units))
    names = [target.name for target in arm.arm.targets]
    target = np.array([_target(row, names) for row in rows], dtype=np.int64)
    return AskedPlaces(rows, Commands.of(arm.arm, joints, sides), target, sides is not None)


def predict_places(arm: IdentifiedArm, asked: AskedPlaces) -> PredictedPlaces:
    """Predict where the targets of rows are."""
    places = np.zeros((len(asked.rows), 3))
    covariance = np.zeros((len(asked.rows), 3, 3))
    for number in np.unique(asked.target).tolist():
        of_it = np.flatnonzero(asked.target == number)
        places[of_it], covariance[of_it] = arm.places_mm(asked.commands.some(of_it), number)
    return PredictedPlaces(asked, places, covariance)


def predict_distances(arm: IdentifiedArm, asked: AskedPlaces) -> Distances:
    """Predict distances from targets to anchors: what the instrument says, dead paths left out.

    Raises:
        UsageError: the result knows no such anchor, or not the dead path of a segment; names file and line.
    """
    known, covariance = arm.distances, arm.with_distances
    length, u = np.zeros(len(asked.rows)), np.zeros(len(asked.rows))
    for k, row in enumerate(asked.rows):
        anchor, segment = row.cells["anchor"], row.cells.get("segment", "")
        path = f"{anchor}#{segment}"
        if anchor not in known.anchors:
            raise row.fault(
                f"the result has no anchor {anchor!r}; it has {', '.join(known.anchors) or 'none'}"
            )
        if segment and path not in known.dead_paths:
            raise row.fault(f"the result does not know the dead path of {path}: leave the segment empty")
        at = asked.commands.some(np.array([k]))
        places, moved = arm.moved_mm(at, int(asked.target[k]))
        beam = places[0] - known.anchors[anchor]
        towards = beam / np.linalg.norm(beam)
        own = known.moved(anchor, path if segment else "", towards)
        slope = np.concatenate([towards @ moved[0], own])
        length[k] = np.linalg.norm(beam) - (known.dead_paths[path] if segment else 0.0)
        u[k] = np.sqrt(max(float(slope @ covariance @ slope), 0.0) + arm.left_mm**2)
    return Distances(length, u)


def write_predicted_places(predicted: PredictedPlaces, joints: JointSource, path: Path) -> None:
    """Write the rows with the places that were predicted.

    Args:
        joints: of the result; a column says it where places are not those of commanded joints.
    """
    values = np.column_stack([predicted.places_mm, predicted.u_mm])
    _write(predicted.asked, _OF_PLACES, values, joints, path)


def write_predicted_distances(asked: AskedPlaces, found: Distances, joints: JointSource, path: Path) -> None:
    """Write the rows with the distances that were predicted; see `write_predicted_places`."""
    values = np.column_stack([found.distance_mm, found.u_mm])
    _write(asked, _OF_DISTANCES, values, joints, path)


def _write(
    asked: AskedPlaces, added: tuple[str, ...], values: Floats, joints: JointSource, path: Path
) -> None:
    # Readers of tables may know no comments: what marks a table stands in its rows.
    mark = {} if joints == "commanded" else {"joints": joints}
    header = [*asked.rows[0].cells, *added, *mark]
    body = (
        [*row.cells.values(), *(f"{value:.6f}" for value in own), *mark.values()]
        for row, own in zip(asked.rows, values.tolist(), strict=True)
    )
    write_atomically(path, csv_text(header, body))


def _target(row: CsvRow, names: list[str]) -> int:
    name = row.cells.get("target", "")
    of_tool = [one for one in names if one != FLANGE] or names
    if not name and len(of_tool) == 1:
        return names.index(of_tool[0])
    if name in names:
        return names.index(name)
    known = ", ".join(names)
    raise (
        row.fault(f"the calibrated arm has no target {name!r}; it has {known}")
        if name
        else UsageError(f"{row.path}: column target is missing: say which of {known} each row means")
    )
