"""Section about the validation path."""

import math

import numpy as np

from app.analysis.validation import ModelOnPath, PathValidation
from app.report.content import MODEL_TITLES, ReportContent
from app.report.drawing import figure
from app.report.figures.path_deviation import path_figure
from app.report.figures.path_vectors import MAGNIFICATION, vector_figure
from app.report.markup import Html, bullets, paragraphs, section, table
from app.report.numbers import fixed, signed
from app.report.path_view import Gap, PathAxis, gaps, path_axis


def path_section(content: ReportContent) -> Html:
    """Return figures and comparison on the validation path."""
    validation = content.validation
    if validation is None:
        return Html()
    axis, left_out = path_axis(validation.path), gaps(validation, content.error_map)
    deviations = figure(
        path_figure(validation, left_out),
        "path",
        "Deviations along the validation path",
        f"{_definitions(axis)} × there, + back: measured; circles and squares: predicted, error bars: standard "
        "uncertainty of the prediction (k = 1). Grey: not compared.",
    )
    vectors = figure(
        vector_figure(validation),
        "vectors",
        "Error vectors on the validation path",
        f"Error vectors from command (black dots) to actual position, magnified {MAGNIFICATION} times. The last "
        "panel, measured minus the model, is what a compensation with the model would leave.",
    )
    return section(
        "validation",
        "Validation path",
        paragraphs(_measured(validation, axis)),
        _comparison(validation),
        bullets(_gap_texts(left_out, axis)) if left_out else "",
        deviations,
        vectors,
    )


def _definitions(axis: PathAxis) -> str:
    parts = [
        f"{symbol.replace('{', '').replace('}', '')}: {meaning}" for symbol, meaning, _ in axis.deviations
    ]
    return "Actual minus command position. " + ", ".join(parts) + "."


def _measured(validation: PathValidation, axis: PathAxis) -> str:
    compared, rows = int(validation.compared.sum()), validation.compared.size
    return (
        f"Path {axis.title}; {rows} positions located by an independent instrument {_stated(validation)}. "
        f"{compared} rows compared, {rows - compared} left out; all models are compared over the same rows."
    )


def _stated(validation: PathValidation) -> str:
    """Return what the instrument says about its uncertainty."""
    stated = 1e3 * validation.path.u_mm[np.isfinite(validation.path.u_mm)]
    if stated.size < validation.path.u_mm.size:
        return (
            "that states no uncertainty"
            if not stated.size
            else "that states an uncertainty for some of them only"
        )
    low, high = float(stated.min()), float(stated.max())
    u = f"{low:.1f}" if math.isclose(low, high, abs_tol=0.05) else f"{low:.1f} to {high:.1f}"
    return f"with a standard uncertainty of {u} µm a coordinate"


def _comparison(validation: PathValidation) -> Html:
    head = [
        "model",
        "rms x / µm",
        "rms y / µm",
        "rms 2D / µm",
        "largest / µm",
        "ratio",
        "u of prediction / µm",
    ]
    head += ["rotation / mdeg", "shift x / mm", "shift y / mm"]
    reference = validation.models[0].comparison.rms_2d_um
    rows = [_row(model, reference) for model in validation.models]
    inner = table("Measured minus predicted position, and the rigid alignment of the measurement", head, rows)
    note = (
        "Ratio: 2D rms over that of the first model. Distances cannot fix the rotation about J1, and the instrument "
        "has a frame of its own: the measurement was turned about the J1 axis and shifted onto each model by least "
        "squares (rotation counter-clockwise). u of prediction: median of the 2D standard uncertainty."
    )
    return Html(inner + paragraphs(note))


def _row(model: ModelOnPath, reference_um: float) -> list[str]:
    comparison, transform = model.comparison, model.comparison.transform
    rms_x, rms_y = comparison.rms_um
    u_um = 1e3 * float(np.median(np.hypot(*model.prediction.u_mm[comparison.inside].T)))
    return [
        MODEL_TITLES[model.model],
        *(fixed(value, 1) for value in (rms_x, rms_y, comparison.rms_2d_um, comparison.max_um)),
        fixed(comparison.rms_2d_um / reference_um, 2) if reference_um > 0.0 else fixed(None, 2),
        fixed(u_um, 1),
        signed(1e3 * math.degrees(transform.rotation_rad), 2),
        *(signed(float(shift), 4) for shift in transform.shift_mm),
    ]


def _gap_texts(left_out: list[Gap], axis: PathAxis) -> list[str]:
    """Return a sentence for each reason, with all its stretches."""
    name = axis.label.removesuffix(" / mm")
    stretches: dict[str, list[str]] = {}
    for gap in left_out:
        stretches.setdefault(gap.reason, []).append(f"{fixed(gap.low_mm, 0)} … {fixed(gap.high_mm, 0)}")
    return [f"{name} {', '.join(parts)} mm: {reason}." for reason, parts in stretches.items()]
