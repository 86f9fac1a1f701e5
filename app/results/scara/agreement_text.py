"""What the stated uncertainties account for, in a sentence."""

from catseye.app.results.numbers import probability_text
from catseye.app.results.scara.path_view import model_title
from catseye.app.results.scara.validation import ModelOnPath


def agreement_text(model: ModelOnPath) -> str:
    """Return whether what a model leaves on a path is what its uncertainties let expect."""
    judged, left_um = model.agreement, model.comparison.rms_2d_um
    whose = (
        "prediction and instrument" if judged.instrument else "the prediction (the instrument states none)"
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
        f"that is left: {figures} ({probability_text(judged.probability)}). The rest: what the model does not know, "
        f"repeatability and drift of the arm{'' if judged.instrument else ', scatter of the instrument'}."
    )
