"""What models leave on a path, in sentences."""

import numpy as np

from catseye.app.results.model import Sign, Statement
from catseye.app.results.numbers import probability_text
from catseye.app.results.said import before_and_after
from catseye.app.results.scara.path_view import model_title, path_axis
from catseye.app.results.scara.validation import ModelOnPath, PathValidation
from catseye.calibration.core.significance import SIGNIFICANCE
from catseye.calibration.core.types import Bools

_BETTER = 0.8
"""An error map that leaves more than this share of the conventional model's error has not earned its keep."""

LEFT_OUT = "(beyond the nodes, or a joint has just reversed)"
"""Why rows of a path are not compared."""


def compared_text(compared: Bools) -> str:
    """Return how many rows were compared."""
    return f"{int(np.sum(compared))} of {compared.size} rows compared"


def ratio_statement(
    left: str, first: str, ratio: float | None, rows: str, short: str, probability: float | None
) -> Statement:
    """Return whether the last model leaves clearly less than the first, and no more than its uncertainties explain.

    Args:
        left: what the last model leaves.
        first: what the first one leaves.
        ratio: of both; None where there is one model.
        short: what both leave, in a few words.
        probability: of what the last one leaves, by its uncertainties; None where nothing judges that.
    """
    rejected = probability is not None and probability < SIGNIFICANCE
    chance = "" if probability is None else f", {probability_text(probability)}"
    rows = f"({rows}{chance}{': more than the uncertainties explain' if rejected else ''})"
    if ratio is None:
        return Statement(Sign.ATTENTION if rejected else Sign.NEUTRAL, f"{left} {rows}.")
    better = Sign.ATTENTION if rejected else Sign.GOOD
    sign = better if ratio < _BETTER else Sign.BAD
    figure = f"{short}{chance}" if rejected else short
    return Statement(sign, f"{left}, {first}: ratio {ratio:.2f} {rows}.", figure)


def path_statement(validation: PathValidation | None) -> Statement:
    """Return what the last model leaves on the path, and how much less than the first."""
    if validation is None:
        return Statement(
            Sign.NEUTRAL, "The prediction has not been checked against an independent instrument."
        )
    last, first = validation.models[-1], validation.models[0]
    left_um, first_um = last.comparison.rms_2d_um, first.comparison.rms_2d_um
    return ratio_statement(
        f"On the path {path_axis(validation.path).title} the {model_title(last)} leaves "
        f"{left_um:.1f} µm rms (2D)",
        f"the {model_title(first)} {first_um:.1f} µm",
        validation.ratio,
        compared_text(validation.compared),
        before_and_after(f"{model_title(first)} {first_um:.1f} µm", f"{model_title(last)} {left_um:.1f} µm"),
        last.agreement.probability if last.agreement.expected_um > 0.0 else None,
    )


def agreement_text(model: ModelOnPath) -> str:
    """Return whether what a model leaves on a path agrees with its uncertainties."""
    judged, left_um = model.agreement, model.comparison.rms_2d_um
    whose = (
        "prediction, arm and instrument"
        if judged.instrument
        else "prediction and arm (the instrument states none)"
    )
    figures = f"{left_um:.1f} µm (2D rms) are left, {judged.expected_um:.1f} µm are expected"
    if judged.expected_um <= 0.0:
        return f"{model_title(model)}: {left_um:.1f} µm (2D rms) are left; no uncertainty is stated to judge them by."
    if judged.agrees:
        return (
            f"{model_title(model)}: what is left agrees with the uncertainties of {whose}: {figures} "
            f"({probability_text(judged.probability)})."
        )
    return (
        f"{model_title(model)}: the uncertainties of {whose} explain {100.0 * judged.share:.0f} % of the variance "
        f"that is left: {figures} ({probability_text(judged.probability)}). The rest comes from effects that "
        f"neither model nor error budget contains{'' if judged.instrument else ', scatter of the instrument'}."
    )


def agreement_statement(model: ModelOnPath) -> Statement:
    """Return the same with its sign."""
    judged = model.agreement
    if judged.expected_um <= 0.0:
        return Statement(Sign.NEUTRAL, agreement_text(model))
    return Statement(Sign.GOOD if judged.agrees else Sign.BAD, agreement_text(model))
