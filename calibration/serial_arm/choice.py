"""Which model, and which joints: decided by what is predicted of poses that were left out, not by hand."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from catseye.calibration.core.errors import CalibrationError, InsufficientPointsError
from catseye.calibration.core.robust import Loss, robust_estimate
from catseye.calibration.core.types import Bools, Floats, Ints
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.carried_models import carried_models
from catseye.calibration.serial_arm.fitted import Fitted, identified, with_shared, without_wrong_poses
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.held_out import HeldOut, RejectedPose
from catseye.calibration.serial_arm.identification import MODELS, Calibration, ModelName
from catseye.calibration.serial_arm.joint_source import JointSource
from catseye.calibration.serial_arm.left_out_poses import (
    by_command_mm,
    pose_of_errors,
    predict_left_out,
    richest_without_wrong,
    same_command,
)
from catseye.calibration.serial_arm.measurements import Measurements


@dataclass(frozen=True)
class Candidate:
    """A model that was tried.

    Attributes:
        joints: what the poses are taken to be.
        mean_mm: mean error of the poses left out, the same ones of all candidates; None where it was not compared.
        reason: why it was not.
        effective: parameters that the rows pay for; None where the measurements do not identify it.
        behind_mm: mean over the poses by which it misses them more than the model that misses them least.
        u_behind_mm: standard error of that.
    """

    name: ModelName
    joints: JointSource
    mean_mm: float | None
    reason: str = ""
    effective: float | None = None
    behind_mm: float | None = None
    u_behind_mm: float | None = None


@dataclass(frozen=True)
class Chosen:
    """What was identified, and what else was tried.

    Attributes:
        calibration: of the best model.
        frames: base and tool alone, with the same poses.
        rejected: poses that contradict all others and were left out.
        joints: what the poses are taken to be.
        drift_mm: how far the base went that the estimate reckons with, root mean square of its coordinates; None
            where no drift is seen, or a robust loss takes its place.
        scatter_mm: by which each pose is off as a whole, a coordinate; None likewise.
        candidates: models that were tried.
        held_out: errors of the best model on poses left out.
        contradicting: numbers of poses that contradict all others and were kept, since a robust loss bears them.
    """

    calibration: Calibration
    frames: Calibration
    rejected: tuple[RejectedPose, ...]
    joints: JointSource
    drift_mm: float | None
    scatter_mm: float | None
    candidates: tuple[Candidate, ...]
    held_out: HeldOut
    contradicting: tuple[int, ...] = ()


def choose(
    arm: SerialArm,
    measurements: Measurements,
    read_back: Floats | None = None,
    name: ModelName | Literal["auto"] = "auto",
    loss: Loss | None = None,
) -> Chosen:
    """Identify an arm with the model and the joints that predict poses best that were left out.

    The simplest model is taken that misses them by no more than one standard error beyond the one that misses them
    least, and the commanded joints unless those read back are better by more than that.

    Args:
        read_back: joints as the controller said them at the poses, shape (n, joints).
        name: model; the best one is found if nothing is said.
        loss: robust loss of the rows of the model that is found, with all poses, which are taken for independent;
            without one poses that contradict all others are left out. Models are compared without it.

    Raises:
        CalibrationError: no model can be identified; the text says why.
    """
    names = MODELS if name == "auto" else (name,)
    best = _best_trial(arm, measurements, read_back, names)
    clean, rejected = without_wrong_poses(arm, best.rows, best.name)
    frames = identified(arm, clean.model.measurements, "frames")
    borne: tuple[int, ...] = ()
    if loss is None:
        found = with_shared(clean)
    else:
        found = Fitted(_robust(arm, best.rows, clean, loss), None, None)
        borne = tuple(one.pose for one in rejected)
        frames, rejected = _robust(arm, best.rows, frames, loss), ()
    pose = pose_of_errors(best.rows)
    kept = np.isin(pose, found.calibration.model.measurements.poses)
    held_out = HeldOut(best.errors_mm[kept], pose[kept])
    return Chosen(
        found.calibration,
        frames,
        rejected,
        best.joints,
        found.drift_mm,
        found.scatter_mm,
        best.candidates,
        held_out,
        borne,
    )


def _robust(arm: SerialArm, rows: Measurements, clean: Calibration, loss: Loss) -> Calibration:
    """Return the parameters of a model from all rows, by a loss that wrong ones hardly move."""
    model = replace(clean.model, arm=arm, measurements=rows)
    begun = replace(clean.estimate, residuals_mm=model.residuals(clean.estimate.values))
    found = robust_estimate(model, begun, loss)
    return replace(clean, model=model, estimate=found.estimate)


@dataclass(frozen=True)
class _Trial:
    """The models tried with one kind of joints.

    Attributes:
        name: of the model that is taken.
        errors_mm: of it at points and distances left out, shape (m,).
        scored: flags of those that models are compared by, shape (m,).
    """

    joints: JointSource
    rows: Measurements
    name: ModelName
    errors_mm: Floats
    scored: Bools
    candidates: tuple[Candidate, ...]


def _best_trial(
    arm: SerialArm, measurements: Measurements, read_back: Floats | None, names: Sequence[ModelName]
) -> _Trial:
    command = same_command(measurements)
    kinds: list[tuple[JointSource, Measurements]] = [("commanded", measurements)]
    if read_back is not None:
        read = Commands.of(arm, read_back, measurements.commands.approach)
        kinds.append(("read back", replace(measurements, commands=read)))
    best: _Trial | None = None
    error: CalibrationError | None = None
    for joints, rows in kinds:
        try:
            trial = _trial(arm, rows, names, joints, command)
        except CalibrationError as why:
            error = error or why
            continue
        best = trial if best is None or _beats(trial, best, command) else best
    if best is None:
        raise error or InsufficientPointsError("there is nothing to identify a model from")
    return best


def _beats(trial: _Trial, simpler: _Trial, command: Ints) -> bool:
    """Return whether other joints miss the poses less, by more than a standard error."""
    both = trial.scored & simpler.scored
    errors, others = (by_command_mm(one.errors_mm, one.rows, command, both) for one in (trial, simpler))
    behind, u_behind = _behind(others, errors)
    return behind > u_behind


def _trial(
    arm: SerialArm, rows: Measurements, names: Sequence[ModelName], joints: JointSource, command: Ints
) -> _Trial:
    """Compare models with one kind of joints.

    Raises:
        CalibrationError: none is identified, or none predicts poses that are left out.
    """
    carried = carried_models(arm, rows, names)
    wrong = [one.pose for one in richest_without_wrong(arm, rows, carried.able)[1]]
    predicted = predict_left_out(arm, rows, carried.able, command)
    determined = np.any([np.isfinite(one) for one in predicted.errors_mm.values()], axis=0)
    if not determined.any():
        why = predicted.reasons.get(
            carried.able[0], "each pose has a target, an anchor or a segment of its own"
        )
        raise InsufficientPointsError(f"no pose can be predicted from the others, measure at more: {why}")
    reasons = carried.reasons | {
        name: _undetermined(errors, determined, rows, predicted.reasons.get(name, ""))
        for name, errors in predicted.errors_mm.items()
        if np.isnan(errors[determined]).any()
    }
    compared = [name for name in carried.able if name not in reasons] or carried.able[:1]
    scored = determined & np.isfinite(predicted.errors_mm[compared[0]])
    scored &= ~np.isin(pose_of_errors(rows), wrong)
    means = {name: by_command_mm(predicted.errors_mm[name], rows, command, scored) for name in compared}
    least = min(means.values(), key=lambda one: float(one.mean()))
    behind = {name: _behind(one, least) for name, one in means.items()}
    taken = next(name for name, (by, u) in behind.items() if by <= u)
    candidates = tuple(
        Candidate(
            name,
            joints,
            float(means[name].mean()) if name in means else None,
            reasons.get(name) or predicted.reasons.get(name, ""),
            carried.effective.get(name),
            *behind.get(name, (None, None)),
        )
        for name in names
    )
    return _Trial(joints, rows, taken, predicted.errors_mm[taken], scored, candidates)


def _behind(errors_mm: Floats, least_mm: Floats) -> tuple[float, float]:
    """Return by how much a model misses the same poses more than another, and the standard error of that."""
    apart = errors_mm - least_mm
    scatter = float(np.std(apart, ddof=1)) if len(apart) > 1 else 0.0
    return float(apart.mean()), scatter / math.sqrt(len(apart))


def _undetermined(errors_mm: Floats, determined: Bools, rows: Measurements, why: str) -> str:
    """Return what a model does not predict although another does."""
    pose = pose_of_errors(rows)
    unknown = np.unique(pose[determined & np.isnan(errors_mm)])
    return (
        f"it does not predict {len(unknown)} of {len(np.unique(pose))} poses from the others. {why}".rstrip()
    )
