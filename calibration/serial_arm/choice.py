"""Which model, and which joints: decided by what is predicted of poses that were left out, not by hand."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from catseye.calibration.core.errors import (
    CalibrationError,
    ConvergenceError,
    InsufficientPointsError,
    UnidentifiableError,
)
from catseye.calibration.core.robust import Loss, robust_estimate
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.base_drift import Drift, drift_errors, find_drift
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.held_out import HeldOut, RejectedPose, held_out, without_wrong_poses
from catseye.calibration.serial_arm.identification import (
    MODELS,
    Calibration,
    ModelName,
    identify_arm,
    refined,
)
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.pose_scatter import find_scatter, scatter_errors

JointSource = Literal["commanded", "read back"]

_BETTER = 0.99
"""Mean error of held-out poses, over that of a simpler model, that makes a richer one worth its parameters."""


_HARMONIC_SIZES_DEG = (0.003, 0.01, 0.03)
"""Standard deviations of the maps' amplitudes that are tried."""


@dataclass(frozen=True)
class Candidate:
    """A model that was tried.

    Attributes:
        joints: what the poses are taken to be.
        mean_mm: mean error of the poses left out; None where the measurements do not identify it.
        reason: why they do not.
    """

    name: ModelName
    joints: JointSource
    mean_mm: float | None
    reason: str = ""


@dataclass(frozen=True)
class Chosen:
    """What was identified, and what else was tried.

    Attributes:
        calibration: of the best model.
        frames: base and tool alone, with the same poses.
        rejected: poses that contradict all others.
        joints: what the poses are taken to be.
        drift: of the base; None where none is seen.
        scatter_mm: by which each pose is off as a whole, a coordinate; None where it is not seen.
        candidates: models that were tried.
        held_out: errors of the best model on poses left out.
    """

    calibration: Calibration
    frames: Calibration
    rejected: tuple[RejectedPose, ...]
    joints: JointSource
    drift: Drift | None
    scatter_mm: float | None
    candidates: tuple[Candidate, ...]
    held_out: HeldOut


def choose(
    arm: SerialArm,
    measurements: Measurements,
    read_back: Floats | None = None,
    name: ModelName | Literal["auto"] = "auto",
    loss: Loss | None = None,
) -> Chosen:
    """Identify an arm with the model and the joints that predict poses best that were left out.

    Args:
        read_back: joints as the controller said them at the poses, shape (n, joints).
        name: model; the best one is found if nothing is said.
        loss: robust loss of the rows of the model that is found, with all poses; without one poses that contradict
            all others are left out.

    Raises:
        CalibrationError: no model can be identified; the text says why.
    """
    names = MODELS if name == "auto" else (name,)
    joints, cleaned, rejected = _cleaned(arm, measurements, read_back, names)
    tried = [_tried(arm, cleaned, one, joints) for one in names]
    able = [found for found, _ in tried if found is not None]
    if not able:
        raise InsufficientPointsError(tried[0][1].reason)
    best = able[0]
    for one in able[1:]:
        if one.errors.mean_mm < _BETTER * best.errors.mean_mm:
            best = one
    frames = identify_arm(arm, cleaned, "frames")
    candidates = tuple(candidate for _, candidate in tried)
    if loss is None:
        return Chosen(
            best.calibration, frames, rejected, joints, best.drift, best.scatter_mm, candidates, best.errors
        )
    every = _robust(arm, _with_joints(arm, measurements, read_back, joints), best.calibration, loss)
    return Chosen(every, frames, (), joints, best.drift, best.scatter_mm, candidates, best.errors)


def _robust(arm: SerialArm, rows: Measurements, clean: Calibration, loss: Loss) -> Calibration:
    """Return the parameters of a model from all rows, by a loss that wrong ones hardly move."""
    model = replace(clean.model, arm=arm, measurements=rows, common=())
    begun = replace(clean.estimate, residuals_mm=model.residuals(clean.estimate.values))
    found = robust_estimate(model, begun, loss)
    return replace(clean, model=model, estimate=found.estimate)


def _with_joints(
    arm: SerialArm, rows: Measurements, read_back: Floats | None, source: JointSource
) -> Measurements:
    if read_back is None or source == "commanded":
        return rows
    return replace(rows, commands=Commands.of(arm, read_back, rows.commands.approach))


@dataclass(frozen=True)
class _Fitted:
    """A model with the drift and the scatter that it sees, and what it predicts of poses left out."""

    calibration: Calibration
    drift: Drift | None
    scatter_mm: float | None
    errors: HeldOut


def _cleaned(
    arm: SerialArm, measurements: Measurements, read_back: Floats | None, names: Sequence[ModelName]
) -> tuple[JointSource, Measurements, tuple[RejectedPose, ...]]:
    """Return the better joints, and the measurements without poses that contradict the others."""
    known: tuple[JointSource, ...] = ("commanded",) if read_back is None else ("commanded", "read back")
    sources = [(one, _with_joints(arm, measurements, read_back, one)) for one in known]
    found = [(source, rows, *_without_wrong(arm, rows, names)) for source, rows in sources]
    best = found[0]
    for other_found in found[1:]:
        if held_out(other_found[2]).mean_mm < _BETTER * held_out(best[2]).mean_mm:
            best = other_found
    source, rows, _, rejected = best
    kept = np.ones(len(rows.commands), dtype=np.bool_)
    kept[[one.pose for one in rejected]] = False
    return source, rows.at(kept), rejected


def _without_wrong(
    arm: SerialArm, measurements: Measurements, names: Sequence[ModelName]
) -> tuple[Calibration, tuple[RejectedPose, ...]]:
    """Return the richest model that the poses identify, but for maps, and the poses that contradict it."""
    error: CalibrationError | None = None
    for name in reversed([one for one in names if one != "maps"] or ["geometric+compliance"]):
        try:
            return without_wrong_poses(arm, measurements, name)
        except (InsufficientPointsError, UnidentifiableError) as why:
            error = error or why
    raise error or InsufficientPointsError("there is no model to identify")


def _tried(
    arm: SerialArm, measurements: Measurements, name: ModelName, joints: JointSource
) -> tuple[_Fitted | None, Candidate]:
    sizes = _HARMONIC_SIZES_DEG if name == "maps" else _HARMONIC_SIZES_DEG[:1]
    try:
        fitted = [_fitted(identify_arm(arm, measurements, name, harmonic_u_deg=size)) for size in sizes]
    except (InsufficientPointsError, UnidentifiableError, ConvergenceError) as why:
        return None, Candidate(name, joints, None, str(why))
    best = min(fitted, key=lambda one: one.errors.mean_mm)
    return best, Candidate(name, joints, best.errors.mean_mm)


def _fitted(found: Calibration) -> _Fitted:
    drift = find_drift(found)
    if drift is not None:
        found = refined(found, (drift_errors(found.model, found.estimate.values, drift),))
    scatter_mm = find_scatter(found)
    if scatter_mm is not None:
        found = refined(found, (*found.model.common, scatter_errors(found.model, scatter_mm)))
    return _Fitted(found, drift, scatter_mm, held_out(found))
