"""Section about the validation path."""

import math

import numpy as np

from catseye.app.render.drawing import figure
from catseye.app.render.markup import Html, bullets, paragraphs, section, table
from catseye.app.results.numbers import fixd, probability_text, signd
from catseye.app.results.scara.agreement_text import agreement_text
from catseye.app.results.scara.circle_table import circle_table
from catseye.app.results.scara.content import ReportContent
from catseye.app.results.scara.figures.path import path_figure
from catseye.app.results.scara.path_view import Gap, PathAxis, gaps, model_title, path_axis
from catseye.app.results.scara.repeat_table import repeat_table
from catseye.app.results.scara.trajectory_section import trajectory_section
from catseye.app.results.scara.validation import ModelOnPath, PathValidation


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
        f"{_definitions(axis)} × there, + back: measured; circles, squares or lines: predicted, error bars or bands: "
        "standard uncertainty of the prediction (k = 1). Below each: measured minus predicted; yellow: ±2 standard "
        "uncertainties of that difference. Grey: not compared.",
    )
    return section(
        "validation",
        "Validation path",
        paragraphs(_measured(validation, axis)),
        _comparison(validation),
        _agreement(validation),
        bullets(_gap_texts(left_out, axis)) if left_out else "",
        deviations,
        trajectory_section(validation),
        circle_table(validation),
        repeat_table(validation),
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
    reference = validation.models[0].comparison.rms_2d_um
    rows = [_row(model, reference) for model in validation.models]
    return Html(
        table("Measured minus predicted position", head, rows)
        + paragraphs(
            "Ratio: 2D rms over that of the first model. u of prediction: median of the 2D standard uncertainty."
        )
    )


def _row(model: ModelOnPath, reference_um: float) -> list[str]:
    comparison = model.comparison
    rms_x, rms_y = comparison.rms_um
    u_um = 1e3 * float(np.median(np.hypot(*model.prediction.u_mm[comparison.inside].T)))
    return [
        model_title(model),
        *(fixd(value, 1) for value in (rms_x, rms_y, comparison.rms_2d_um, comparison.max_um)),
        fixd(comparison.rms_2d_um / reference_um, 2) if reference_um > 0.0 else fixd(None, 2),
        fixd(u_um, 1),
    ]


def _agreement(validation: PathValidation) -> Html:
    """Return the alignment with its uncertainties, and what the stated uncertainties account for."""
    head = ["model", "rotation / mdeg", "u", "shift x / mm", "u", "shift y / mm", "u"]
    head += ["rms 2D expected / µm", "share explained", "within ±2 u", "p"]
    rows = [_judged(model) for model in validation.models]
    note = (
        "Distances cannot fix the rotation about J1, and the instrument has a frame of its own: the measurement was "
        "turned about the J1 axis (counter-clockwise) and shifted onto each model by least squares. Expected: "
        "√(trace W / n), with W = P V P; V is the covariance of measured minus predicted coordinates (prediction and "
        "instrument), P takes off what a rotation and a shift absorb. Share explained: trace W over the sum of "
        "squared differences. p: probability of differences this large if the stated uncertainties are all there is "
        "(χ² with the effective degrees of freedom of W). The arm's own repeatability is part of what is measured; "
        "where the instrument's uncertainty does not include it, it belongs to what is not explained."
    )
    told = bullets(agreement_text(model) for model in validation.models)
    return Html(
        table("Alignment, and agreement with the uncertainties", head, rows) + told + paragraphs(note)
    )


def _judged(model: ModelOnPath) -> list[str]:
    transform, judged = model.comparison.transform, model.agreement
    cells = [
        model_title(model),
        signd(1e3 * math.degrees(transform.rotation_rad), 2),
        fixd(1e3 * math.degrees(judged.u_rotation_rad), 2),
    ]
    for shift, u in zip(transform.shift_mm, judged.u_shift_mm, strict=True):
        cells += [signd(float(shift), 4), fixd(float(u), 4)]
    return [
        *cells,
        fixd(judged.expected_um, 1),
        f"{fixd(100.0 * judged.share, 0)} %",
        f"{fixd(100.0 * judged.within, 0)} %",
        probability_text(judged.probability).removeprefix("p ").removeprefix("= "),
    ]


def _gap_texts(left_out: list[Gap], axis: PathAxis) -> list[str]:
    """Return a sentence for each reason, with all its stretches."""
    name = axis.label.removesuffix(" / mm")
    stretches: dict[str, list[str]] = {}
    for gap in left_out:
        stretches.setdefault(gap.reason, []).append(f"{fixd(gap.low_mm, 0)} … {fixd(gap.high_mm, 0)}")
    return [f"{name} {', '.join(parts)} mm: {reason}." for reason, parts in stretches.items()]
