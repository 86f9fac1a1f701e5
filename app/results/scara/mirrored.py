"""A measurement whose frame is left-handed: known by what remains when x and y are exchanged."""

from catseye.app.results.scara.validation import PathValidation
from catseye.calibration.scara.comparison import compare

_CLEARLY = 0.5
"""A mirrored measurement that leaves less than this share is no accident."""


def mirrored_text(validation: PathValidation) -> str:
    """Return a sentence about a left-handed frame; empty when nothing speaks for one.

    On a straight path only the model can see that one axis points the wrong way.

    Args:
        validation: the measurement as it is; its last model is the best one.
    """
    path, best = validation.path, validation.models[-1]
    last, predicted = best.comparison, best.prediction.position_mm
    exchanged = compare(path.command_mm, predicted, path.measured_mm[:, ::-1], last.inside)
    if exchanged.rms_2d_um > _CLEARLY * last.rms_2d_um:
        return ""
    return (
        f"the measured positions leave {last.rms_2d_um:.1f} µm (2D rms) as they are and {exchanged.rms_2d_um:.1f} µm "
        "with x and y exchanged: the instrument's frame seems to be left-handed; exchange x_meas_mm and y_meas_mm"
    )
