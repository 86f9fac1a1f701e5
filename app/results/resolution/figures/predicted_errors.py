"""Predicted and measured step errors of the tool at a pose (Fig. 10 of the resolution paper)."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from catseye.app.results.figures import Band, Figure, Line, Mark, Panel, Role
from catseye.app.results.resolution.cartesian_comparison import Compared, direction_word
from catseye.app.results.resolution.figures.panels import (
    BEYOND,
    aspect_of,
    error_panel,
    in_rows,
    least_step_mark,
    measured_points,
)
from catseye.app.results.resolution.predicted import PredictedCurve

_DIRECTIONS: Final = ("+X", "+Y", "+Z", "-X", "-Y", "-Z")
_CAPTION: Final = (
    "Step error over the commanded step of the tool. Line and band: predicted error, ± one standard deviation of a "
    "single step; points: measured steps; dashed: threshold; upright: least increment step, dotted as predicted, "
    f"dash-dotted as measured. The prediction ends where the tables of a joint end. {BEYOND}"
)


def predicted_error_figure(pose: str, compared: Sequence[Compared]) -> Figure | None:
    """Return the errors of steps at a pose, a panel a direction; None where no direction is predicted.

    Args:
        pose: its name.
        compared: directions at any pose.
    """
    here = {direction_word(one.test): one for one in compared if (one.test.pose or "") == pose}
    panels = [_panel(word, here[word]) if word in here else None for word in _DIRECTIONS]
    if not any(panels):
        return None
    rows = tuple(row for row in in_rows(panels) if any(row))
    label = f"Predicted and measured step errors at {pose}"
    return Figure(f"predicted-{pose}", label, f"{pose}. {_CAPTION}", rows, aspect=aspect_of(rows))


def _panel(direction: str, one: Compared) -> Panel | None:
    least = one.predicted
    if least is None or least.curve is None:
        return None
    measured = Role.CONVENTIONAL
    marks: list[Mark] = [
        measured_points(one.test, measured, "measured"),
        *_predicted_marks(least.curve),
    ]
    if least.lis is not None:
        marks.append(least_step_mark(least.lis, Role.QUANTILE))
    if one.test.lis is not None:
        marks.append(least_step_mark(one.test.lis.value, measured, "dash-dotted"))
    return error_panel(direction.replace("-", "−"), one.test.unit, [one.test], marks)


def _predicted_marks(curve: PredictedCurve) -> tuple[Mark, Mark]:
    x, mean, std = np.log10(curve.command), np.array(curve.mean_percent), np.array(curve.std_percent)
    return (
        Band(x, mean - std, mean + std, Role.QUANTILE),
        Line(x, mean, Role.QUANTILE, "predicted", width=1.6),
    )
