"""A path as it was measured, before any model is known: deviations from what was commanded."""

from typing import Final

import numpy as np

from catseye.app.results.figures import Axis, Figure, Ink, Level, Mark, Panel, Points, Role
from catseye.app.results.scara.path_view import PathAxis, path_axis, there
from catseye.app.results.scara.validation import FEWEST_ROWS, PathMeasurement
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.scara.comparison import rigid_fit

NO_RESULT: Final = "there is no result of this cell beside the runs"


def measured_path_figure(path: PathMeasurement, why_not: str) -> Figure | None:
    """Return both deviations along the path; None while too few positions tell the instrument's frame.

    Args:
        why_not: why nothing is predicted of them.
    """
    if (error_um := deviations_um(path)) is None:
        return None
    axis = path_axis(path)
    panels = tuple(
        (_panel(axis, place, error_um[:, component], there(path)),)
        for place, (_, _, component) in enumerate(axis.deviations)
    )
    caption = (
        "Measured minus command position, the instrument's frame fitted to the commands. Nothing is predicted: "
        f"{why_not}."
    )
    return Figure("measured-path", "Deviations along the path", caption, panels, aspect=0.6)


def deviations_um(path: PathMeasurement) -> Floats | None:
    """Return measured minus command positions, the instrument's frame fitted to the commands, µm, shape (n, 2).

    NaN where nothing was measured; None while too few positions tell the frame.
    """
    known = np.isfinite(path.measured_mm).all(axis=1)
    if int(known.sum()) < FEWEST_ROWS:
        return None
    aligned = rigid_fit(path.measured_mm[known], path.command_mm[known]).apply(path.measured_mm)
    return np.asarray(1e3 * (aligned - path.command_mm), dtype=np.float64)


def _panel(axis: PathAxis, place: int, error_um: Floats, way: Bools) -> Panel:
    symbol, meaning, _ = axis.deviations[place]
    looks: tuple[tuple[Bools, Ink, str, str], ...] = (
        (way, Role.POSITIVE, "x", "way there"),
        (~way, Role.NEGATIVE, "+", "way back"),
    )
    marks: list[Mark] = [Level(0.0, Role.AXIS, width=0.6)]
    marks += [
        Points(axis.values_mm[own], error_um[own], ink, label, marker=marker, size=4.0, each=True)
        for own, ink, marker, label in looks
        if own.any()
    ]
    across = Axis(axis.label) if place else Axis(shared=True)
    return Panel(meaning, across, Axis("µm", symbol), tuple(marks))
