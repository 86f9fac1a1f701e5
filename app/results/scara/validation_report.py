"""What models leave on a path that an independent instrument measured."""

import math
from collections.abc import Sequence

import numpy as np

from catseye.app.results.model import Bullets, Cell, Column, Paragraph, Section, Table, section
from catseye.app.results.numbers import COUNT, EXPANDED, MDEG_PER_RAD, PERCENT, PROBABILITY, fixed, number
from catseye.app.results.scara.circle_table import circle_blocks
from catseye.app.results.scara.compensation_proof import gain_blocks
from catseye.app.results.scara.figures.path import path_figures
from catseye.app.results.scara.figures.trajectories import trajectory_figure
from catseye.app.results.scara.path_view import Gap, PathAxis, gaps, model_title, path_axis
from catseye.app.results.scara.repeated_poses import repeat_blocks
from catseye.app.results.scara.result import Result
from catseye.app.results.scara.validation import ModelOnPath, PathValidation
from catseye.app.results.scara.validation_text import LEFT_OUT, agreement_statement

_UM = fixed(1)


def path_section(
    validation: PathValidation | None, error_map: Result | None, lines: Sequence[int] = ()
) -> Section:
    """Return figures and comparison on the validation path.

    Args:
        validation: what was compared; None gives an empty section.
        error_map: names the joints that leave its nodes.
        lines: of the path's file, one a row; empty for a run.
    """
    if validation is None:
        return section("validation", "Validation path", ())
    axis, left_out = path_axis(validation.path), gaps(validation, error_map)
    return section(
        "validation",
        "Validation path",
        [
            Paragraph(_measured(validation, axis)),
            *gain_blocks(validation),
            comparison_table(validation, lines),
            Paragraph(
                "Ratio: 2D rms over that of the first model. U of prediction: median of the 2D uncertainty (k = 2)."
            ),
            line_table(validation),
            _agreement(validation.models),
            expected_table(validation.models),
            *(agreement_statement(model) for model in validation.models),
            Paragraph(_AGREEMENT_NOTE),
            Bullets("", _gap_texts(left_out, axis)) if left_out else None,
            *path_figures(validation, left_out),
            trajectory_figure(validation),
            *circle_blocks(validation),
            *repeat_blocks(validation),
        ],
        brief=True,
    )


_AGREEMENT_NOTE = (
    "Distances cannot fix the rotation about J1, and the instrument has a frame of its own: the measurement was "
    "turned about the J1 axis (counter-clockwise) and shifted onto each model by least squares. Expected: "
    "√(trace W / n), with W = P V P; V is the covariance of measured minus predicted coordinates (identified "
    "parameters, what lies between the nodes, repeatability and radial error motions of the arm, instrument), P "
    "takes off what a rotation and a shift absorb. Share explained: trace W over the sum of squared differences. p: "
    "probability of differences this large if the stated uncertainties are all there is (a sum of χ² in the "
    "sizes of the eigenvalues of W)."
)


def _measured(validation: PathValidation, axis: PathAxis) -> str:
    compared, rows = int(validation.compared.sum()), validation.compared.size
    return (
        f"Path {axis.title}; {rows} positions located by an independent instrument {_stated(validation)}. "
        f"{compared} rows compared, {rows - compared} left out {LEFT_OUT}; all models are compared over the same "
        "rows."
    )


def _stated(validation: PathValidation) -> str:
    """Return what the instrument says about its uncertainty."""
    stated = 1e3 * EXPANDED * validation.path.u_mm[np.isfinite(validation.path.u_mm)]
    if not stated.size:
        return "that states no uncertainty"
    if stated.size < validation.path.u_mm.size:
        return "that states an uncertainty for some of them only"
    low, high = float(stated.min()), float(stated.max())
    expanded = f"{low:.1f}" if math.isclose(low, high, abs_tol=0.05) else f"{low:.1f} to {high:.1f}"
    return f"with U = {expanded} µm (k = 2) a coordinate"


def comparison_table(validation: PathValidation, lines: Sequence[int] = ()) -> Table:
    """Return what each model leaves on the path.

    Args:
        lines: of the path's file, one a row; empty for a run.
    """
    first_um = validation.models[0].comparison.rms_2d_um
    return Table(
        "models",
        "Measured minus predicted position",
        (
            Column("model", "model"),
            Column("rms_x_um", "rms x", "µm", _UM),
            Column("rms_y_um", "rms y", "µm", _UM),
            Column("rms_um", "rms 2D", "µm", _UM),
            Column("max_um", "largest", "µm", _UM),
            Column("ratio", "ratio", format=fixed(3)),
            Column("median_u_um", "U of prediction", "µm", _UM, standard=True),
            *((Column("max_line", "largest in line", format=COUNT),) if lines else ()),
        ),
        tuple(
            (*_compared(model, first_um), *((lines[model.comparison.worst],) if lines else ()))
            for model in validation.models
        ),
    )


def _compared(model: ModelOnPath, first_um: float) -> tuple[Cell, ...]:
    comparison = model.comparison
    return (
        model_title(model),
        *comparison.rms_um,
        comparison.rms_2d_um,
        comparison.max_um,
        comparison.rms_2d_um / first_um if first_um > 0.0 else None,
        model.median_u_um,
    )


def line_table(validation: PathValidation) -> Table | None:
    """Return what each model leaves on each line; None for one line."""
    path = validation.path
    if path.numbers is None or len(path.lines) < 2:
        return None
    rows: list[tuple[Cell, ...]] = []
    for own in path.lines:
        left = [model.comparison.difference_mm[own] for model in validation.models]
        known = validation.compared[own]
        rms = [
            1e3 * float(np.sqrt(np.mean(np.sum(one[known] ** 2, axis=1)))) if known.any() else None
            for one in left
        ]
        rows.append((int(path.numbers[own.start]), int(known.sum()), *rms))
    return Table(
        "lines",
        "Measured minus predicted position, line by line",
        (
            Column("line", "line", format=COUNT),
            Column("n", "rows compared", format=COUNT),
            *(
                Column(f"rms_{number}_um", f"rms 2D, {model_title(model)}", "µm", _UM)
                for number, model in enumerate(validation.models)
            ),
        ),
        tuple(rows),
    )


def _agreement(models: Sequence[ModelOnPath]) -> Table:
    """Return the alignment with its uncertainties, and what the stated uncertainties account for."""
    turned, shifted, angle, length = fixed(2, signed=True), fixed(4, signed=True), fixed(2), fixed(4)
    return Table(
        "alignment",
        "Alignment, and agreement with the uncertainties",
        (
            Column("model", "model"),
            Column("rotation_mdeg", "rotation", "mdeg", turned),
            Column("u_rotation_mdeg", "U", format=angle, standard=True),
            Column("shift_x_mm", "shift x", "mm", shifted),
            Column("u_shift_x_mm", "U", format=length, standard=True),
            Column("shift_y_mm", "shift y", "mm", shifted),
            Column("u_shift_y_mm", "U", format=length, standard=True),
            Column("expected_um", "rms 2D expected", "µm", _UM),
            Column("share_explained", "share explained", format=PERCENT),
            Column("within_2u", "within ±2 u", format=PERCENT),
            Column("probability", "p", format=PROBABILITY),
        ),
        tuple(_judged(model) for model in models),
    )


def _judged(model: ModelOnPath) -> tuple[Cell, ...]:
    transform, judged = model.comparison.transform, model.agreement
    shifts = [float(x) for pair in zip(transform.shift_mm, judged.u_shift_mm, strict=True) for x in pair]
    return (
        model_title(model),
        MDEG_PER_RAD * transform.rotation_rad,
        MDEG_PER_RAD * judged.u_rotation_rad,
        *shifts,
        judged.expected_um,
        judged.share,
        judged.within,
        judged.probability,
    )


def expected_table(models: Sequence[ModelOnPath]) -> Table:
    """Return what the expected differences are made of, contributor by contributor."""
    names = list(dict.fromkeys(name for model in models for name in model.agreement.parts_um))
    return Table(
        "expected",
        "Expected 2D rms, by contributor",
        (
            Column("contributor", "contributor"),
            *(
                Column(f"model_{number}", model_title(model), "µm", _UM)
                for number, model in enumerate(models)
            ),
        ),
        tuple((name, *(model.agreement.parts_um.get(name) for model in models)) for name in names),
    )


def _gap_texts(left_out: Sequence[Gap], axis: PathAxis) -> tuple[str, ...]:
    """Return a sentence for each reason, with all its stretches."""
    name = axis.label.removesuffix(" / mm")
    stretches: dict[str, list[str]] = {}
    for gap in left_out:
        ends = (number(end, fixed(0)) for end in (gap.low_mm, gap.high_mm))
        stretches.setdefault(gap.reason, []).append(" … ".join(ends))
    return tuple(f"{name} {', '.join(parts)} mm: {reason}." for reason, parts in stretches.items())
