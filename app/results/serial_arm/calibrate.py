"""From measured poses to a result: identification, and the content of a result file."""

from collections.abc import Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

import numpy as np

from catseye.app.cell.arm import ArmDescription
from catseye.app.cell.tool import ToolDescription
from catseye.app.results.provenance import Provenance
from catseye.app.results.serial_arm.anchors import read_anchors
from catseye.app.results.serial_arm.measured_poses import read_measured_poses
from catseye.app.results.serial_arm.nominal_arm import serial_arm_of
from catseye.app.results.serial_arm.result import (
    CandidatePart,
    FitPart,
    FramesPart,
    HeldOutPart,
    ParameterPart,
    RejectedPart,
    SerialArmResult,
)
from catseye.app.store.software import SOFTWARE
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.absolute import absolute, base_place
from catseye.calibration.serial_arm.choice import Chosen, choose
from catseye.calibration.serial_arm.identification import Calibration, ModelName
from catseye.calibration.serial_arm.parameters import FRAME_PARTS, AnchorPlace, BaseFrame, DeadPath, Parameter
from catseye.calibration.serial_arm.plausibility import require_plausible


@dataclass(frozen=True)
class Subject:
    """What is calibrated.

    Attributes:
        name: of the arm, as it was given.
        description: of the arm.
        tool: its tool; None where the places of the targets are unknown.
    """

    name: str
    description: ArmDescription
    tool: ToolDescription | None


def calibrate_tables(
    subject: Subject, poses: Sequence[Path], anchors: Path | None, model: ModelName | Literal["auto"]
) -> SerialArmResult:
    """Calibrate an arm from tables.

    Raises:
        UsageError: a table is missing or wrong; names file and line.
        CalibrationError: the tables contradict the arm, or do not identify it; the likely mistake is named.
    """
    nominal = serial_arm_of(subject.description, subject.tool)
    known = {} if anchors is None else read_anchors(anchors)
    tables = read_measured_poses(poses, subject.description, nominal, known)
    require_plausible(tables.arm, tables.measurements)
    found = choose(tables.arm, tables.measurements, tables.read_back, model)
    provenance = Provenance(
        runs=[str(path) for path in poses],
        software=SOFTWARE,
        created=datetime.now(UTC).isoformat(timespec="seconds"),
    )
    return result_of(subject, found, provenance)


def result_of(subject: Subject, found: Chosen, provenance: Provenance) -> SerialArmResult:
    """Return an identification as a result."""
    calibration = found.calibration
    fit = calibration.estimate.fit
    known = absolute(calibration)
    return SerialArmResult(
        arm=subject.name,
        model=calibration.name,
        parameters=_parameters(calibration),
        null_directions=[list(names) for names in calibration.null_directions],
        correlation=known.correlation.tolist(),
        fit=FitPart(
            n_rows=fit.n_points,
            n_parameters=fit.n_parameters,
            rms_mm=1e-3 * fit.rms_um,
            chi2_reduced=fit.chi2_reduced,
            chi2_probability=fit.chi2_probability,
            lack_of_fit=_lacks(calibration),
        ),
        cross_validation=HeldOutPart(mean_mm=found.held_out.mean_mm, max_mm=found.held_out.max_mm),
        rejected=[
            RejectedPart(pose=one.name, error_mm=one.error_mm, probability=one.probability)
            for one in found.rejected
        ],
        provenance=provenance,
        joints=found.joints,
        base_drift_mm=None if found.drift is None else found.drift.size_mm,
        candidates=[
            CandidatePart(model=one.name, mean_mm=one.mean_mm, reason=one.reason) for one in found.candidates
        ],
        frames=_frames(found.frames),
        description=subject.description,
        tool=subject.tool,
    )


def _lacks(calibration: Calibration) -> bool:
    fit = calibration.estimate.fit
    by_repeats = fit.lack_of_fit is not None and fit.lack_of_fit.significant
    return by_repeats or (fit.chi2_probability is not None and fit.chi2_probability < SIGNIFICANCE)


def _parameters(calibration: Calibration) -> list[ParameterPart]:
    """Return base and links in the order of the model, then those that keep their values."""
    known, place = absolute(calibration), base_place(calibration.geometry)
    identified = [
        _part(one, float(value), float(u), identified=True)
        for one, value, u in zip(calibration.model.chosen, known.values, known.u, strict=True)
    ]
    held = [
        _part(one, float(place[FRAME_PARTS.index(one.role.part)]), 0.0, identified=False)
        if isinstance(one.role, BaseFrame)
        else _part(one, value, 0.0, identified=False)
        for one, value in calibration.model.held
    ]
    return identified + held


def _part(parameter: Parameter, value: float, u: float, *, identified: bool) -> ParameterPart:
    return ParameterPart(
        name=parameter.name,
        value=value,
        u=u,
        unit=parameter.unit,
        nominal=None if isinstance(parameter.role, BaseFrame | DeadPath) else parameter.nominal,
        identified=identified,
        of_distances=isinstance(parameter.role, AnchorPlace | DeadPath),
    )


def _frames(frames: Calibration) -> FramesPart:
    errors = _point_errors_mm(frames)
    return FramesPart(
        mean_mm=float(errors.mean()),
        std_mm=float(errors.std()),
        max_mm=float(errors.max()),
        parameters=_parameters(frames),
    )


def _point_errors_mm(calibration: Calibration) -> Floats:
    """Return the errors of points (3-D) and of distances."""
    residuals, rows = calibration.estimate.residuals_mm, calibration.model.measurements
    points, turned = len(rows.points.pose), len(rows.orientations.pose)
    first = 3 * (points + turned)
    apart = np.abs(residuals[first : first + len(rows.distances.pose)])
    return np.concatenate([np.linalg.norm(residuals[: 3 * points].reshape(-1, 3), axis=1), apart])
