"""Deviations of measured distances along a validation path."""

import numpy as np

from catseye.app.results.figures import Axis, Figure, Panel, Points, Role
from catseye.app.results.scara.distance_validation import DistanceValidation, ModelOnDistances
from catseye.app.results.scara.names import MODEL_TITLES
from catseye.calibration.core.types import Bools, Floats


def distance_figure(distances: DistanceValidation) -> Figure:
    """Return a panel for each model."""
    y, there = distances.path.command_mm[:, 1], distances.path.travel > 0
    panels = tuple(_panel("abcdef"[place], model, y, there) for place, model in enumerate(distances.models))
    return Figure(
        "path-distances",
        "Deviations of distances along the validation path",
        "Predicted minus measured distance; error bars: standard uncertainty of the prediction (k = 1). One dead "
        "path is fitted for each segment and model.",
        (panels,),
        aspect=0.43,
    )


def _panel(letter: str, model: ModelOnDistances, y: Floats, there: Bools) -> Panel:
    known = np.isfinite(model.deviation_mm)
    ways = ((there, Role.POSITIVE, "o", "there"), (~there, Role.NEGATIVE, "s", "back"))
    marks = tuple(
        Points(
            y[rows & known],
            1e3 * model.deviation_mm[rows & known],
            ink,
            f"way {name}",
            1e3 * model.u_mm[rows & known],
            marker=marker,
            size=4.0,
            hollow=True,
        )
        for rows, ink, marker, name in ways
    )
    first = letter == "a"
    upwards = Axis("predicted − measured / µm" if first else "", shared=not first)
    return Panel(f"{letter}) {MODEL_TITLES[model.model]}", Axis("Y / mm"), upwards, marks)
