"""What is said of a calibrated serial arm: verdict, parameters, models that were tried, poses that were left out."""

from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.results.figures import Figure
from catseye.app.results.model import (
    Block,
    Bullets,
    Column,
    Quantity,
    Report,
    Section,
    Sign,
    Statement,
    Table,
    section,
)
from catseye.app.results.numbers import CONVENTION_OF_U, PROBABILITY, THREE_DIGITS, fixed
from catseye.app.results.serial_arm.certificate import certificate
from catseye.app.results.serial_arm.figures import deviations, histograms, places
from catseye.app.results.serial_arm.parameter_format import parameter_format
from catseye.app.results.serial_arm.result import (
    CandidatePart,
    ParameterPart,
    SerialArmResult,
    read_serial_arm,
)
from catseye.app.results.serial_arm.verdict import verdict

_MM: Final = fixed(3)

_PAIRS: Final = 12
"""Correlations that are named."""

_CONVENTIONS: Final = (
    "Parameters are modified Denavit–Hartenberg: T = Rx(α) Ry(β) Tx(a) Rz(θ) Tz(d), θ = sign · q + offset; β only of "
    "an axis that is nominally parallel to the one before.",
    "base: the arm's base in the frame of the measured places, R = Rz·Ry·Rx. Places of a run with three fixed nests "
    "stand in the world frame of these, others in that of the instrument.",
    "A compliance is the turn of a joint for each N·mm of gravity torque about its +z.",
    CONVENTION_OF_U,
    "A parameter that was not identified keeps its nominal value.",
    "Poses left out: a tenth of the poses at a time is predicted by a calibration from the others. Errors are "
    "predicted minus measured, as 3-D norms.",
)


def calibration_file_report(path: Path) -> Report:
    """Return the report of a result file.

    Raises:
        UsageError: the file is missing or no result; names what is wrong.
    """
    return calibration_report(f"Result {path.name}", read_serial_arm(path))


def calibration_report(heading: str, result: SerialArmResult) -> Report:
    """Return the report of a calibration."""
    sections = (
        section("verdict", "Verdict", verdict(result), brief=True),
        certificate(result),
        section("accuracy", "Before and after", [_accuracy(result)], brief=True),
        section("errors", "Errors by pose", _error_figures(result)),
        section("parameters", "Parameters", [_parameters(result.parameters)], brief=True),
        section("deviations", "Deviations from the drawing", _deviation_figures(result)),
        section("correlations", "Strongest correlations", [_correlations(result)]),
        section("masses", "Masses that are not quite known", _masses(result)),
        section("models", "Models that were tried", [_candidates(result)]),
        section("rejected", "Poses that were left out", [_rejected(result)] if result.rejected else []),
        _redundant(result),
        section("conventions", "Conventions", [Bullets("", _CONVENTIONS)]),
    )
    return Report(heading, result.origin, sections)


def _accuracy(result: SerialArmResult) -> Table:
    rows: list[tuple[str | float | None, ...]] = []
    if result.frames is not None:
        rows.append(("links as drawn, frames fitted", result.frames.mean_mm, result.frames.max_mm))
    rows.append(
        (f"{result.model}, poses left out", result.cross_validation.mean_mm, result.cross_validation.max_mm)
    )
    columns = (
        Column("state", "state"),
        Column("mean_mm", "mean error", "mm", _MM),
        Column("max_mm", "largest", "mm", _MM),
    )
    return Table("accuracy", "Position errors at the targets", columns, tuple(rows))


def _error_figures(result: SerialArmResult) -> list[Figure]:
    errors = result.errors
    if errors is None or not errors.frames_mm:
        return []
    left_out = np.array([np.nan if one is None else one for one in errors.left_out_mm])
    known = np.isfinite(left_out)
    states = [
        ("links as drawn, frames fitted", np.array(errors.frames_mm)),
        (f"{result.model}, poses left out", left_out[known]),
    ]
    shown = [histograms("errors", "Position errors before and after", states)] if known.any() else []
    return [*shown, places(np.array(errors.place_mm)[known], left_out[known])] if shown else []


def _deviation_figures(result: SerialArmResult) -> list[Figure]:
    figures = []
    for unit in ("mm", "deg", "rad/(N·mm)"):
        parts = [
            (one.name, one.value - one.nominal, one.u)
            for one in result.parameters
            if one.identified and one.unit == unit and one.nominal is not None and not one.of_distances
        ]
        if parts:
            names, values, u = zip(*parts, strict=True)
            figures.append(deviations(names, np.array(values), np.array(u), unit))
    return figures


def _correlations(result: SerialArmResult) -> Table | None:
    names = [one.name for one in result.parameters if one.identified]
    matrix = np.triu(np.array(result.correlation).reshape(len(names), len(names)), 1)
    order = np.argsort(np.abs(matrix), axis=None)[::-1][:_PAIRS]
    pairs = [(int(i), int(j)) for i, j in zip(*np.unravel_index(order, matrix.shape), strict=True)]
    rows = tuple((names[i], names[j], float(matrix[i, j])) for i, j in pairs if matrix[i, j])
    columns = (
        Column("one", "parameter"),
        Column("other", "with"),
        Column("coefficient", "coefficient", "", fixed(2, signed=True)),
    )
    return Table("correlations", "Correlation coefficients", columns, rows) if rows else None


def _masses(result: SerialArmResult) -> list[Block]:
    masses = result.masses
    if masses is None:
        return []
    return [
        Statement(
            Sign.NEUTRAL,
            f"Simulated: with every mass and centre of gravity wrong by {100.0 * masses.share:.0f} %, up or down, "
            f"and nothing else wrong, the calibrated arm would miss by {masses.mean_mm:.3f} mm on average, "
            f"{masses.max_mm:.3f} mm at most ({masses.draws} sets of masses, random poses all over the ranges).",
        )
    ]


def _parameters(parameters: list[ParameterPart]) -> Table:
    columns = (
        Column("name", "parameter"),
        Column("value", "value"),
        Column("u", "U", standard=True),
        Column("unit", "unit"),
        Column("nominal", "nominal"),
        Column("identified", "identified"),
    )
    rows = []
    for one in parameters:
        form = parameter_format(one.unit)
        rows.append(
            (
                one.name,
                Quantity(one.value, form),
                Quantity(one.u if one.identified else None, THREE_DIGITS),
                one.unit,
                Quantity(one.nominal, form),
                "yes" if one.identified else "held",
            )
        )
    return Table("parameters", "Parameters", columns, tuple(rows))


def _candidates(result: SerialArmResult) -> Table:
    columns = (
        Column("model", "model"),
        Column("mean_mm", "mean error", "mm", _MM),
        Column("behind_mm", "above the least, mm"),
        Column("effective_parameters", "effective parameters", "", fixed(1)),
        Column("reason", "remark"),
    )
    rows = tuple(
        (one.model, one.mean_mm, _behind(one), one.effective_parameters, one.reason or None)
        for one in result.candidates
    )
    return Table(
        "models",
        "Errors of poses left out: the simplest model within one standard error of the least is taken",
        columns,
        rows,
    )


def _behind(candidate: CandidatePart) -> str | None:
    if candidate.behind_mm is None or candidate.u_behind_mm is None:
        return None
    return f"{candidate.behind_mm:.4f} ± {candidate.u_behind_mm:.4f}"


def _rejected(result: SerialArmResult) -> Table:
    columns = (
        Column("pose", "pose"),
        Column("error_mm", "missed by", "mm", _MM),
        Column("probability", "probability by chance", "", PROBABILITY),
    )
    rows = tuple((one.pose, one.error_mm, one.probability) for one in result.rejected)
    return Table("rejected", "Poses that contradict all others", columns, rows)


def _redundant(result: SerialArmResult) -> Section:
    texts = tuple(f"{names[-1]} is held: {', '.join(names)} say the same" for names in result.null_directions)
    return section(
        "redundant",
        "Parameters that such measurements cannot distinguish",
        [Bullets("", texts)] if texts else [],
    )
