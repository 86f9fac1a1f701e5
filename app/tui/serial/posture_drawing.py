"""A serial arm in two views: along its plane from the side, and from above; bodies as outlines, joints as signs."""

import math
from dataclasses import dataclass
from itertools import pairwise
from typing import Final

import numpy as np

from catseye.app.protocol.posture import Limb, Place, Posture
from catseye.app.tui.widgets.braille import DOTS_ACROSS, DOTS_DOWN, Canvas, Floats
from catseye.app.tui.widgets.inks import Line

BODY: Final = "body"
ARM: Final = "arm"
MOVING: Final = "moving"
TOOL: Final = "tool"
FLOOR: Final = "floor"
WORD: Final = "word"

_BESIDE_COLUMNS: Final = 44
"""Width from which both views stand side by side."""

_BELOW_ROWS: Final = 20
"""Height from which they stand below each other where there is no such width."""

_ROUND_MM: Final = 500.0
"""The scale follows the arm in steps of that, so that it does not shimmer."""

_MARGIN_DOTS: Final = 2.0
_LENGTHS_MM: Final = (2000, 1000, 500, 200, 100, 50, 20, 10)


@dataclass(frozen=True)
class View:
    """A plane onto which an arm is projected, and the scale of its drawing.

    Attributes:
        across: what points to the right, as x, y and z.
        upwards: what points upwards.
        mm_per_dot: the scale, of both directions.
        left_mm: at the leftmost dots.
        top_mm: at the uppermost dots.
    """

    across: Place
    upwards: Place
    mm_per_dot: float = 1.0
    left_mm: float = 0.0
    top_mm: float = 0.0

    def plane_mm(self, place_mm: Place) -> tuple[float, float]:
        """Return how far to the right and upwards a place is in the plane, mm."""
        across_mm, up_mm = (
            sum(part * mm for part, mm in zip(direction, place_mm, strict=True))
            for direction in (self.across, self.upwards)
        )
        return across_mm, up_mm

    def dot(self, place_mm: Place) -> tuple[float, float]:
        """Return where a place is drawn, dots from the upper left corner."""
        across_mm, up_mm = self.plane_mm(place_mm)
        return (across_mm - self.left_mm) / self.mm_per_dot, (self.top_mm - up_mm) / self.mm_per_dot


def from_the_side(posture: Posture) -> View:
    """Return the view onto the plane in which the arm stands."""
    heading_rad = math.radians(posture.heading_deg)
    return View((math.cos(heading_rad), math.sin(heading_rad), 0.0), (0.0, 0.0, 1.0))


FROM_ABOVE: Final = View((1.0, 0.0, 0.0), (0.0, 1.0, 0.0))


def views_of(columns: int, rows: int) -> int:
    """Return how many views have room, 1 or 2."""
    return 2 if columns >= _BESIDE_COLUMNS or rows >= _BELOW_ROWS else 1


def draw_posture(posture: Posture, moving: int | None, columns: int, rows: int) -> list[Line]:
    """Return both views where they have room, else the one from the side.

    Args:
        moving: number of the joint that moves, from 0; None when none does.
        columns: width in cells.
        rows: height in cells.
    """
    side = from_the_side(posture)
    if columns >= _BESIDE_COLUMNS:
        half = (columns - 1) // 2
        left = draw_view(posture, side, moving, half, rows)
        right = draw_view(posture, FROM_ABOVE, moving, columns - 1 - half, rows)
        return [[*a, (" ", ""), *b] for a, b in zip(left, right, strict=True)]
    if rows >= _BELOW_ROWS:
        half = rows // 2
        return [
            *draw_view(posture, side, moving, columns, half),
            *draw_view(posture, FROM_ABOVE, moving, columns, rows - half),
        ]
    return draw_view(posture, side, moving, columns, rows)


def draw_view(posture: Posture, view: View, moving: int | None, columns: int, rows: int) -> list[Line]:
    """Return one view of an arm; see `draw_posture`."""
    canvas = Canvas(columns, rows)
    if not (canvas.columns and canvas.rows):
        return []
    view = scaled(view, posture, canvas)
    from_side = view.upwards[2] > 0.0
    if from_side:
        _draw_floor(canvas, view, posture)
    for limb in posture.limbs:
        _draw_limb(canvas, view, limb)
    _draw_joints(canvas, view, posture, moving)
    _write_scale(canvas, view, "↑Z" if from_side else "↑Y →X")
    return list(canvas.lines())


def scaled(view: View, posture: Posture, canvas: Canvas) -> View:
    """Return a view at the largest scale at which all of an arm is seen."""
    radii_mm = [limb.radius_mm for limb in posture.limbs for _ in range(2)]
    ends_mm = [end for limb in posture.limbs for end in (limb.start_mm, limb.end_mm)]
    ends_mm += posture.joints_mm
    radii_mm += [0.0] * len(posture.joints_mm)
    plane_mm = np.array([view.plane_mm(end) for end in ends_mm])
    reach_mm = np.array(radii_mm)[:, None]
    low_mm = _ROUND_MM * np.floor((plane_mm - reach_mm).min(axis=0) / _ROUND_MM)
    high_mm = _ROUND_MM * np.ceil((plane_mm + reach_mm).max(axis=0) / _ROUND_MM)
    room = np.maximum([canvas.width - 2.0 * _MARGIN_DOTS, canvas.height - 2.0 * _MARGIN_DOTS], 1.0)
    mm_per_dot = float(np.max(np.maximum(high_mm - low_mm, _ROUND_MM) / room))
    middle_mm = 0.5 * (low_mm + high_mm)
    left_mm = float(middle_mm[0] - 0.5 * (canvas.width - 1) * mm_per_dot)
    top_mm = float(middle_mm[1] + 0.5 * (canvas.height - 1) * mm_per_dot)
    return View(view.across, view.upwards, mm_per_dot, left_mm, top_mm)


def _draw_floor(canvas: Canvas, view: View, posture: Posture) -> None:
    y = view.dot((0.0, 0.0, posture.table_z_mm))[1]
    canvas.line((0.0, y), (canvas.width - 1.0, y), FLOOR, 2)


def _draw_limb(canvas: Canvas, view: View, limb: Limb) -> None:
    """Draw the outline of a body: seen from anywhere, it is what lies within its radius of a line."""
    start, end = np.array(view.dot(limb.start_mm)), np.array(view.dot(limb.end_mm))
    radius = limb.radius_mm / view.mm_per_dot
    along = end - start
    # Dots count downwards, angles counter-clockwise as they are seen.
    angle_rad = math.atan2(-along[1], along[0])
    beside = radius * np.array([-math.sin(angle_rad), -math.cos(angle_rad)])
    for one, other in ((start + beside, end + beside), (start - beside, end - beside)):
        canvas.line(_pair(one), _pair(other), BODY)
    quarter = 0.5 * math.pi
    canvas.arc(_pair(end), radius, angle_rad - quarter, angle_rad + quarter, BODY)
    canvas.arc(_pair(start), radius, angle_rad + quarter, angle_rad + 3.0 * quarter, BODY)


def _draw_joints(canvas: Canvas, view: View, posture: Posture, moving: int | None) -> None:
    dots = [view.dot(place) for place in posture.joints_mm]
    for start, end in pairwise(dots):
        canvas.line(start, end, ARM)
    # What is drawn last stands above: the joint that moves.
    signs = [(joint, "○", ARM) for joint in range(1, len(dots) - 1)]
    signs.append((len(dots) - 1, "◎", TOOL))
    if moving is not None:
        signs.append((moving + 1, "●", MOVING))
    for joint, sign, ink in signs:
        x, y = dots[joint]
        canvas.text(round(x) // DOTS_ACROSS, round(y) // DOTS_DOWN, sign, ink)


def _write_scale(canvas: Canvas, view: View, axes: str) -> None:
    """Draw a length that fits into a third of the width, and write where the axes point."""
    fits = (each for each in _LENGTHS_MM if each / view.mm_per_dot <= canvas.width / 3.0)
    if (length_mm := next(fits, None)) is not None:
        end, y = length_mm / view.mm_per_dot, canvas.height - 2.0
        canvas.line((0.0, y), (end, y), WORD)
        canvas.text(round(end) // DOTS_ACROSS + 1, canvas.rows - 1, f"{length_mm} mm", WORD)
    canvas.text(0, 0, axes, WORD)


def _pair(dot: Floats) -> tuple[float, float]:
    return float(dot[0]), float(dot[1])
