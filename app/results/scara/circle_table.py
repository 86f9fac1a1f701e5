"""Quantities after ISO 230-4 of a path that is a circle, driven in both senses."""

import numpy as np

from catseye.app.results.model import Block, Cell, Column, Paragraph, Table
from catseye.app.results.numbers import PLAIN, fixed, number
from catseye.app.results.scara.path_view import model_title
from catseye.app.results.scara.validation import PathValidation
from catseye.calibration.core.types import Bools, Floats
from catseye.calibration.standards.circular import Circular, algebraic_centre, circular, least_squares_centre

_ROUND = 1e-3
"""A path whose radii differ by less than this share is a circle."""

_WHOLE_RAD = 1.9 * np.pi
"""Travel of a sense that counts as a whole circle."""

_UM, _SIGNED = fixed(1), fixed(1, signed=True)
_COLUMNS = (
    Column("contour", "contour"),
    Column("clockwise_um", "G clockwise", "µm", _UM),
    Column("counter_clockwise_um", "G counter-clockwise", "µm", _UM),
    Column("bidirectional_um", "G(b)", "µm", _UM),
    Column("largest_um", "F max", "µm", _SIGNED),
    Column("smallest_um", "F min", "µm", _SIGNED),
    Column("mean_um", "D", "µm", _SIGNED),
)


def circle_blocks(validation: PathValidation) -> list[Block]:
    """Return circular errors as measured and as far as models predict them; empty for any other path."""
    command = validation.path.command_mm
    centre = algebraic_centre(command)
    radius = np.hypot(*(command - centre).T)
    if np.ptp(radius) > _ROUND * float(radius.mean()):
        return []
    turn = np.diff(np.unwrap(np.arctan2(*(command - centre).T[::-1])), prepend=np.nan)
    turn[0] = turn[1]
    clockwise, counter = turn < 0.0, turn > 0.0
    if min(np.abs(turn[clockwise]).sum(), turn[counter].sum()) < _WHOLE_RAD:
        return []
    nominal_mm, last = float(radius.mean()), validation.models[-1]
    shapes = [("measured", last.comparison.aligned_mm)]
    shapes += [(model_title(model), model.prediction.position_mm) for model in validation.models]
    rows = [
        _row(name, _quantities(places, nominal_mm, clockwise, counter))
        for name, places in shapes
        if np.isfinite(places).all()
    ]
    return [
        Table("circular", "Circular test, quantities of ISO 230-4", _COLUMNS, tuple(rows)),
        Paragraph(
            f"Circle of {number(round(nominal_mm, 3), PLAIN)} mm radius. G: circular error of each sense, G(b): "
            "bidirectional circular error, F: radial errors from the nominal circle, D: mean bidirectional radial "
            "error; all about the centre of the least-squares circle through both contours. A model stands here when "
            "it predicts the whole circle."
        ),
    ]


def _quantities(places: Floats, nominal_mm: float, clockwise: Bools, counter: Bools) -> Circular:
    centre = least_squares_centre(places)
    error = np.hypot(*(places - centre).T) - nominal_mm
    return circular(error[clockwise], error[counter])


def _row(name: str, circle: Circular) -> tuple[Cell, ...]:
    ranges = (circle.clockwise, circle.counter_clockwise, circle.bidirectional)
    errors = (circle.largest, circle.smallest, circle.mean)
    return (name, *(1e3 * one for one in (*ranges, *errors)))
