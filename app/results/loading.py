"""What `catseye.load` gives: runs, results and cells as objects, each by what its path holds."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TypeAlias

import numpy as np

from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Cell
from catseye.app.errors import UsageError
from catseye.app.results.resolution.predicted import PREDICTED_FORMAT, PredictedResolution, read_predicted
from catseye.app.results.resolution.result import RESOLUTION_FORMAT, ResolutionResult, read_resolution
from catseye.app.results.result_file import format_of
from catseye.app.results.scara.result import Result, read_result
from catseye.app.results.serial_arm.identified_arm import IdentifiedArm, identified_arm
from catseye.app.results.serial_arm.result import SERIAL_ARM_FORMAT, SerialArmResult, read_serial_arm
from catseye.app.store.reader import RunReader, accept
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.geometry import Commands

_SCARA_FORMAT = "catseye-result/1"


@dataclass(frozen=True)
class CalibratedArm:
    """A calibrated serial arm.

    Attributes:
        result: parameters with their uncertainties, fit, models that were tried, provenance.
    """

    result: SerialArmResult

    @property
    def targets(self) -> tuple[str, ...]:
        """Names of the targets on its tool."""
        return self._found.target_names

    def value(self, name: str) -> tuple[float, float]:
        """Return a parameter and its standard uncertainty (k = 1), in the unit that its name ends with.

        Raises:
            UsageError: the result has no such parameter.
        """
        for one in self.result.parameters:
            if one.name == name:
                return one.value, one.u
        raise UsageError(f"the result has no parameter {name}; result.parameters has their names")

    def places_mm(self, joints: Floats, target: str, approach: Floats | None = None) -> tuple[Floats, Floats]:
        """Return where a target is at commanded joints.

        Args:
            joints: deg, or mm of a prismatic joint, shape (n, joints).
            target: its name.
            approach: side that each joint comes from, 1 from below, −1 from above, shape (n, joints); from below
                without it.

        Returns:
            Places in the frame of the instrument, mm, shape (n, 3), and their covariances, mm², shape (n, 3, 3).

        Raises:
            UsageError: the tool has no such target, or joints or sides have another shape.
        """
        return self._found.places_mm(self._commands(joints, approach), self._found.number_of(target))

    def compensated(self, joints: Floats, target: str, approach: Floats | None = None) -> Floats:
        """Return the joints that bring a target to where the nominal arm would have it, as `catseye compensate` does.

        The target is where it was identified on the flange.

        Args:
            joints: of the nominal arm, deg, or mm of a prismatic joint, shape (n, joints).
            target: its name.
            approach: side that each joint comes from, 1 from below, −1 from above, shape (n, joints); from below
                without it.

        Returns:
            Joints, shape (n, joints); NaN in the rows of poses that the arm does not reach.

        Raises:
            UsageError: the tool has no such target, or joints or sides have another shape.
        """
        asked = self._commands(joints, approach)
        return self._found.compensated(asked.joints, target, asked.approach).joints

    @cached_property
    def _found(self) -> IdentifiedArm:
        return identified_arm(self.result)

    def _commands(self, joints: Floats, approach: Floats | None) -> Commands:
        given, count = np.asarray(joints, dtype=np.float64), len(self._found.arm.joint_names)
        if given.ndim != 2 or given.shape[1] != count:  # rows and columns
            raise UsageError(f"joints have the shape {given.shape}: give (n, {count}), one row a pose")
        if approach is None:
            return Commands.of(self._found.arm, given)
        sides = np.asarray(approach, dtype=np.float64)
        if sides.shape != given.shape or (np.abs(sides) != 1.0).any():
            raise UsageError(
                f"approach has the shape {sides.shape}: give {given.shape}, 1 where a joint comes from below and -1 "
                "where from above"
            )
        return Commands.of(self._found.arm, given, sides)


Loaded: TypeAlias = RunReader | Cell | Result | CalibratedArm | ResolutionResult | PredictedResolution


def load(source: str | Path, *, unverified: bool = False) -> Loaded:
    """Return what a path holds.

    Args:
        source: folder of a run, a result file, or a cell file.
        unverified: take a sealed run that was changed afterwards, too.

    Returns:
        A `RunReader` (procedure, status, `rows(table)`, `events()`) of a run; a `Result` of a SCARA's, a
        `CalibratedArm` of a serial arm's and a `ResolutionResult` or `PredictedResolution` of motion resolution's
        result file; a `Cell` of a cell file.

    Raises:
        UsageError: there is nothing, or nothing that the program knows.
        ConfigError: the cell file cannot be used.
        StorageError: the run is damaged.
    """
    path = Path(source)
    if path.is_dir():
        return RunReader(path, accept(unverified=unverified))
    if path.suffix.lower() == ".toml":
        return load_cell(path).cell
    stated = format_of(path)
    match stated:
        case "catseye-result/1":
            return read_result(path)
        case "catseye-serial-arm/1":
            return CalibratedArm(read_serial_arm(path))
        case "catseye-resolution/1":
            return read_resolution(path)
        case "catseye-predicted-resolution/1":
            return read_predicted(path)
    known = ", ".join((_SCARA_FORMAT, SERIAL_ARM_FORMAT, RESOLUTION_FORMAT, PREDICTED_FORMAT))
    raise UsageError(
        f"{path}: its format is {stated or 'not stated'}; catseye.load takes folders of runs, "
        f"cell files (*.toml) and result files ({known})"
    )
