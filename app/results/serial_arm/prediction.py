"""Where a calibrated serial arm puts its targets: at the rows of a poses CSV, with uncertainties."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.files.columns import read_rows
from catseye.app.files.csv_lines import CsvRow
from catseye.app.files.csv_text import csv_text
from catseye.app.files.poses import poses_table
from catseye.app.results.serial_arm.identified_arm import IdentifiedArm
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.serial_arm.geometry import Commands

ADDED = ("x_pred_mm", "y_pred_mm", "z_pred_mm", "u_pred_mm")


@dataclass(frozen=True)
class AskedPlaces:
    """Rows of a poses CSV.

    Attributes:
        target: number of each row's target, shape (n,).
    """

    rows: list[CsvRow]
    commands: Commands
    target: Ints


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
    chain = arm.arm.chain
    table = poses_table(["deg" if joint.kind == "revolute" else "mm" for joint in chain.joints])
    rows, columns = read_rows(path, table)
    joints = columns.stacked([column.name for column in table.forms[0]])
    names = [target.name for target in arm.arm.targets]
    target = np.array([_target(row, names) for row in rows], dtype=np.int64)
    return AskedPlaces(rows, Commands.of(arm.arm, joints), target)


def predict_places(arm: IdentifiedArm, asked: AskedPlaces) -> PredictedPlaces:
    """Predict where the targets of rows are."""
    places = np.zeros((len(asked.rows), 3))
    covariance = np.zeros((len(asked.rows), 3, 3))
    for number in np.unique(asked.target).tolist():
        of_it = np.flatnonzero(asked.target == number)
        places[of_it], covariance[of_it] = arm.places_mm(asked.commands.some(of_it), number)
    return PredictedPlaces(asked, places, covariance)


def write_predicted_places(predicted: PredictedPlaces, path: Path) -> None:
    """Write the rows with what was predicted."""
    header = [*predicted.asked.rows[0].cells, *ADDED]
    body = (
        [*row.cells.values(), *(f"{value:.6f}" for value in place), f"{u:.6f}"]
        for row, place, u in zip(predicted.asked.rows, predicted.places_mm, predicted.u_mm, strict=True)
    )
    write_atomically(path, csv_text(header, body))


def _target(row: CsvRow, names: list[str]) -> int:
    name = row.cells.get("target", "")
    if not name and len(names) == 1:
        return 0
    if name in names:
        return names.index(name)
    known = ", ".join(names)
    raise (
        row.fault(f"the calibrated arm has no target {name!r}; it has {known}")
        if name
        else UsageError(f"{row.path}: column target is missing: say which of {known} each row means")
    )
