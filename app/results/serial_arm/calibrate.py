"""From measured poses to a result: identification, and the content of a result file."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Literal

import numpy as np

from catseye.app.cell.arm import ArmDescription
from catseye.app.cell.tool import ToolDescription
from catseye.app.errors import UsageError
from catseye.app.results.provenance import Provenance
from catseye.app.results.serial_arm.anchors import read_anchors
from catseye.app.results.serial_arm.left_over import missed_beyond_mm
from catseye.app.results.serial_arm.measured_poses import MeasuredPoses, read_measured_poses
from catseye.app.results.serial_arm.missing_load import calibrated_without_load
from catseye.app.results.serial_arm.nominal_arm import serial_arm_of
from catseye.app.results.serial_arm.priors import read_priors
from catseye.app.results.serial_arm.result import (
    AnchorPart,
    CandidatePart,
    DrawsPart,
    ErrorsPart,
    FitPart,
    FramesPart,
    HeldOutPart,
    ImplausiblePart,
    MassPart,
    ParameterPart,
    RejectedPart,
    SerialArmResult,
)
from catseye.app.store.software import SOFTWARE
from catseye.calibration.core.coverage import Interval, fewest_draws, shortest_interval
from catseye.calibration.core.robust import Loss
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.absolute import absolute, base_place
from catseye.calibration.serial_arm.arm import SerialArm
from catseye.calibration.serial_arm.bounds import beyond_bounds
from catseye.calibration.serial_arm.choice import Chosen, choose
from catseye.calibration.serial_arm.identification import Calibration, ModelName
from catseye.calibration.serial_arm.mass_errors import mass_errors
from catseye.calibration.serial_arm.monte_carlo import draw_estimates, with_draws
from catseye.calibration.serial_arm.parameters import FRAME_PARTS, AnchorPlace, BaseFrame, DeadPath, Parameter
from catseye.calibration.serial_arm.plausibility import ImplausibleError, outside_ranges, require_plausible
from catseye.calibration.serial_arm.read_back import other_poses
from catseye.calibration.serial_arm.stated_errors import far_more_certain, too_certain
from catseye.calibration.serial_arm.tool_places import contradicted_places

COVERAGE = 0.95
"""Probability that an interval of the result holds its parameter."""

_MOST_NAMED = 4
"""Findings that a refusal names."""


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


@dataclass(frozen=True)
class MonteCarlo:
    """How uncertainties are drawn.

    Attributes:
        draws: how many.
        seed: of the draws.
    """

    draws: int
    seed: int

    def __post_init__(self) -> None:
        fewest = fewest_draws(COVERAGE)
        if self.draws < fewest:
            raise UsageError(
                f"{self.draws} draws are too few for intervals of {100.0 * COVERAGE:.0f} % (JCGM 101 asks for "
                f"{fewest}): --draws {fewest} or more"
            )


@dataclass(frozen=True)
class Method:
    """How a calibration is done.

    Attributes:
        model: the best one where it is "auto".
        loss: of the rows.
        monte_carlo: how uncertainties are propagated; None for the Jacobian.
        accept_implausible: why a result that the gate refuses is kept; None refuses it.
    """

    model: ModelName | Literal["auto"] = "auto"
    loss: Loss | None = None
    monte_carlo: MonteCarlo | None = None
    accept_implausible: str | None = None

    def __post_init__(self) -> None:
        if self.accept_implausible is not None and not self.accept_implausible.strip():
            raise UsageError("--accept-implausible needs a reason: say why the result is kept")
        if self.loss is not None and self.monte_carlo is not None:
            raise UsageError(
                f"--loss {self.loss} takes its uncertainties from the scatter of the rows; Monte Carlo draws are "
                "identified by least squares: omit --loss or --uncertainty monte-carlo"
            )


@dataclass(frozen=True)
class Sources:
    """Files that a calibration reads.

    Attributes:
        poses: tables of measured poses.
        anchors: of distances.
        priors: what is known of parameters beforehand.
    """

    poses: Sequence[Path]
    anchors: Path | None = None
    priors: Path | None = None


def calibrate_tables(subject: Subject, sources: Sources, method: Method) -> SerialArmResult:
    """Calibrate an arm from tables.

    Raises:
        UsageError: a table is missing or wrong; names file and line.
        CalibrationError: the tables contradict the arm, or do not identify it; the likely mistake is named.
    """
    nominal = serial_arm_of(subject.description, subject.tool)
    if sources.priors is not None:
        nominal = replace(nominal, known=read_priors(sources.priors))
    known = {} if sources.anchors is None else read_anchors(sources.anchors)
    tables = read_measured_poses(sources.poses, subject.description, nominal, known)
    provenance = Provenance(
        runs=[str(path) for path in sources.poses],
        software=SOFTWARE,
        created=datetime.now(UTC).isoformat(timespec="seconds"),
    )
    return calibrated(subject, tables, method, provenance)


def calibrated(
    subject: Subject, tables: MeasuredPoses, method: Method, provenance: Provenance
) -> SerialArmResult:
    """Calibrate an arm from measured poses.

    Raises:
        CalibrationError: the poses contradict the arm, or do not identify it; the likely mistake is named.
        UsageError: a parameter that is said to be known beforehand is none of the model.
    """
    findings = _findings_before(tables, method)
    found = choose(tables.arm, tables.measurements, tables.read_back, method.model, method.loss)
    _require_known(tables.arm, found.calibration)
    findings += (*beyond_bounds(found.calibration), *too_certain(found.calibration))
    if findings and method.accept_implausible is None:
        raise ImplausibleError(
            "the result is implausible and not kept: "
            + "; ".join(findings[:_MOST_NAMED])
            + ". Correct that and calibrate again; --accept-implausible TEXT keeps it with a reason"
        )
    kept = None
    if findings:
        kept = ImplausiblePart(accepted=method.accept_implausible or "", findings=list(findings))
    result = result_of(subject, found, provenance, kept)
    changed: dict[str, object] = {"loss": method.loss or "squares"}
    remarks = (
        outside_ranges(tables.arm, tables.measurements),
        _other_poses_read_back(tables),
        far_more_certain(tables.measurements),
        contradicted_places(tables.arm, found.calibration) if _may_lack(found.calibration) else None,
        calibrated_without_load(result),
    )
    changed["remarks"] = [text for text in remarks if text]
    if method.monte_carlo is not None:
        changed |= _drawn(found.calibration, result, method.monte_carlo)
    result = result.model_copy(update=changed)
    return result.model_copy(update={"left_mm": missed_beyond_mm(result, found)})


def _other_poses_read_back(tables: MeasuredPoses) -> str | None:
    if tables.read_back is None:
        return None
    rows = tables.measurements
    return other_poses(tables.arm, rows.commands.joints, tables.read_back, rows.names)


def _findings_before(tables: MeasuredPoses, method: Method) -> tuple[str, ...]:
    """Return what speaks against the tables where that is accepted."""
    try:
        require_plausible(tables.arm, tables.measurements, tables.read_back, tables.tables)
    except ImplausibleError as error:
        if method.accept_implausible is None:
            raise
        return (str(error),)
    return ()


def _require_known(arm: SerialArm, found: Calibration) -> None:
    names = {one.name for one in (*found.model.chosen, *(held for held, _ in found.model.held))}
    unknown = [name for name in arm.known if name not in names]
    if unknown:
        raise UsageError(
            f"the model {found.name} has no parameter {unknown[0]}, which --priors states; it has "
            f"{', '.join(sorted(names))}"
        )


def _drawn(calibration: Calibration, result: SerialArmResult, asked: MonteCarlo) -> dict[str, object]:
    """Return what a Monte Carlo says instead of the Jacobian: uncertainties, intervals, correlations."""
    solved = draw_estimates(calibration, asked.draws, asked.seed)
    known = absolute(with_draws(calibration, solved.parameters))
    moved = (solved.parameters - calibration.estimate.values) @ known.rates.T
    limits = iter(zip(known.u, (shortest_interval(column, COVERAGE) for column in moved.T), strict=True))
    parameters = [
        _with_interval(part, *next(limits)) if part.identified else part for part in result.parameters
    ]
    return {
        "parameters": parameters,
        "correlation": known.correlation.tolist(),
        "monte_carlo": DrawsPart(draws=asked.draws, seed=asked.seed, damped_solutions=solved.fallbacks),
    }


def _with_interval(part: ParameterPart, u: float, about: Interval) -> ParameterPart:
    return part.model_copy(
        update={"u": float(u), "low": part.value + about.low, "high": part.value + about.high}
    )


def result_of(
    subject: Subject, found: Chosen, provenance: Provenance, implausible: ImplausiblePart | None = None
) -> SerialArmResult:
    """Return an identification as a result.

    Args:
        implausible: what the gate found and why it is kept: a result is judged by it from its beginning.
    """
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
        base_drift_mm=found.drift_mm,
        pose_scatter_mm=found.scatter_mm,
        candidates=[
            CandidatePart(
                model=one.name,
                mean_mm=one.mean_mm,
                reason=one.reason,
                effective_parameters=one.effective,
                behind_mm=one.behind_mm,
                u_behind_mm=one.u_behind_mm,
            )
            for one in found.candidates
        ],
        frames=_frames(found.frames),
        description=subject.description,
        tool=subject.tool,
        anchors=_anchors(calibration),
        errors=_errors(found),
        masses=_masses(calibration),
        implausible=implausible,
    )


def _masses(calibration: Calibration) -> MassPart | None:
    found = mass_errors(calibration)
    if found is None:
        return None
    return MassPart(
        share=found.share,
        draws=found.draws,
        mean_mm=float(found.error_mm.mean()),
        max_mm=float(found.error_mm.max()),
    )


def _anchors(calibration: Calibration) -> list[AnchorPart]:
    anchors = calibration.model.measurements.distances.anchors
    places = calibration.model.anchors(calibration.estimate.values)
    return [
        AnchorPart(name=anchor.name, place_mm=(float(x), float(y), float(z)))
        for anchor, (x, y, z) in zip(anchors, places, strict=True)
    ]


def _errors(found: Chosen) -> ErrorsPart:
    """Return the errors of points, before and after, in the order of their rows."""
    rows = found.frames.model.measurements.points
    count, names = len(rows.pose), found.frames.model.measurements.names
    left_out = found.held_out.error_mm[:count]
    return ErrorsPart(
        pose=[names[k] for k in rows.pose],
        target=[found.frames.model.arm.targets[k].name for k in rows.target],
        place_mm=[(float(x), float(y), float(z)) for x, y, z in rows.place_mm],
        frames_mm=_point_errors_mm(found.frames)[:count].tolist(),
        left_out_mm=[None if np.isnan(one) else float(one) for one in left_out],
    )


def _lacks(calibration: Calibration) -> bool:
    fit = calibration.estimate.fit
    by_repeats = fit.lack_of_fit is not None and fit.lack_of_fit.significant
    return by_repeats or (fit.chi2_probability is not None and fit.chi2_probability < SIGNIFICANCE)


def _may_lack(calibration: Calibration) -> bool:
    """Return whether the rows contradict the model, or do not say whether they do."""
    return _lacks(calibration) or not calibration.model.measurements.stated


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
