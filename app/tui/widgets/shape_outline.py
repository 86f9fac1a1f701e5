"""Circles, ellipses and wedges as polygons."""

import math
from itertools import pairwise

import numpy as np

from catseye.app.results.figures import Shape
from catseye.app.tui.widgets.braille import Floats
from catseye.calibration.core.types import Bools


def outline(mark: Shape) -> tuple[Floats, Floats]:
    """Return the outline of a circle, an ellipse or a wedge; a wedge begins and ends in its middle."""
    whole = mark.to_deg - mark.from_deg >= 360.0
    angle, turn = np.deg2rad(np.linspace(mark.from_deg, mark.to_deg, 97)), math.radians(mark.turn_deg)
    along, across = mark.half[0] * np.cos(angle), mark.half[1] * np.sin(angle)
    if not whole:
        along, across = (np.concatenate([[0.0], side, [0.0]]) for side in (along, across))
    return (
        mark.centre[0] + along * math.cos(turn) - across * math.sin(turn),
        mark.centre[1] + along * math.sin(turn) + across * math.cos(turn),
    )


def within(mark: Shape, x: Floats, y: Floats) -> Bools:
    """Return which places lie within a shape (even-odd rule over its outline), shape (n,)."""
    inside: Bools = np.zeros(x.shape, np.bool_)
    edge_x, edge_y = outline(mark)
    corners = list(zip(edge_x.tolist(), edge_y.tolist(), strict=True))
    for (x0, y0), (x1, y1) in pairwise([*corners, corners[0]]):
        if y0 != y1:
            crosses = (y0 > y) != (y1 > y)
            inside ^= crosses & (x < x0 + (y - y0) / (y1 - y0) * (x1 - x0))
    return inside
