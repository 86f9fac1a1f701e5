"""The bench from above, to scale: column, arm, beam, reflectors."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.app.protocol.scara.layout import Layout, ReflectorPlace
from catseye.app.tui.widgets.braille import Canvas
from catseye.calibration.scara.planar import forward

ARM: Final = "arm"
BASE: Final = "base"
BEAM_OK: Final = "beam-ok"
BEAM_LOST: Final = "beam-lost"
BEAM_UNKNOWN: Final = "beam-unknown"
REFLECTOR: Final = "reflector"
AIMED: Final = "aimed"
RANGE: Final = "range"
WORD: Final = "word"

_MARGIN_DOTS: Final = 3.0
_NAME_CELLS: Final = 4
_FIELD_MM: Final = 90.0
_ROOMY_ROWS: Final = 15
_TURN_DEG: Final = 360.0
_DASH: Final = 3
_LENGTHS_MM: Final = (1000, 500, 200, 100, 50, 20, 10)


@dataclass(frozen=True)
class View:
    """How places become dots: one scale for both axes, x to the right, y upwards.

    Attributes:
        mm_per_dot: the scale.
        left_mm: x of the leftmost dots.
        top_mm: y of the uppermost dots.
    """

    mm_per_dot: float
    left_mm: float
    top_mm: float

    def dot(self, x_mm: float, y_mm: float) -> tuple[float, float]:
        """Return where a place is, dots from the upper left corner."""
        return (x_mm - self.left_mm) / self.mm_per_dot, (self.top_mm - y_mm) / self.mm_per_dot


@dataclass(frozen=True)
class Pose:
    """The nominal arm at given joints, mm and rad.

    Attributes:
        elbow_mm: x and y of the J2 axis.
        place_mm: x and y of the J4 axis.
        link1_rad: direction of link 1.
        link2_rad: direction of link 2.
        beam_rad: direction of the beam.
    """

    elbow_mm: tuple[float, float]
    place_mm: tuple[float, float]
    link1_rad: float
    link2_rad: float
    beam_rad: float


def pose_of(layout: Layout, joints: Sequence[float]) -> Pose:
    """Return where the nominal arm is.

    Args:
        joints: J1 deg, J2 deg, J3 mm, J4 deg.
    """
    one, two, four = (math.radians(joints[place]) for place in (0, 1, 3))
    link1_mm, link2_mm = layout.link1_mm, layout.link2_mm
    x_mm, y_mm = forward(np.array(one), np.array(two), link1_mm, link2_mm).tolist()
    elbow_mm = link1_mm * math.cos(one), link1_mm * math.sin(one)
    beam_rad = one + two + four + math.radians(layout.theta40_deg)
    return Pose(elbow_mm, (x_mm, y_mm), one, one + two, beam_rad)


def view_within(reach_mm: float, places_mm: Sequence[tuple[float, float]], canvas: Canvas) -> View:
    """Return the largest scale at which the arm's whole reach and every reflector are seen, wherever the arm is.

    Args:
        places_mm: x and y of the reflectors.
    """
    across = [-reach_mm, reach_mm, *(x_mm for x_mm, _ in places_mm)]
    upwards = [-reach_mm, reach_mm, *(y_mm for _, y_mm in places_mm)]
    width_mm, height_mm = max(across) - min(across), max(upwards) - min(upwards)
    # Names stand right of the reflectors.
    wide = max(canvas.width - 2.0 * _MARGIN_DOTS - 2.0 * _NAME_CELLS, 1.0)
    high = max(canvas.height - 2.0 * _MARGIN_DOTS, 1.0)
    mm_per_dot = max(width_mm / wide, height_mm / high, 1e-6)
    middle_x, middle_y = (max(across) + min(across)) / 2.0, (max(upwards) + min(upwards)) / 2.0
    shift = _NAME_CELLS
    return View(
        mm_per_dot,
        middle_x - (canvas.width - 1) / 2.0 * mm_per_dot + shift * mm_per_dot,
        middle_y + (canvas.height - 1) / 2.0 * mm_per_dot,
    )


def view_of(layout: Layout, canvas: Canvas) -> View:
    """Return the scale at which a bench is drawn."""
    places_mm = [(each.x_mm, each.y_mm) for each in layout.reflectors]
    return view_within(layout.link1_mm + layout.link2_mm, places_mm, canvas)


def draw_plan(
    layout: Layout, joints: Sequence[float] | None, beam_ok: bool | None, columns: int, rows: int
) -> Canvas:
    """Return the bench from above.

    Args:
        joints: J1 deg, J2 deg, J3 mm, J4 deg; None when they are not known.
        beam_ok: the beam comes back; None when that is not known.
        columns: width in cells.
        rows: height in cells.
    """
    canvas = Canvas(columns, rows)
    if not (canvas.columns and canvas.rows):
        return canvas
    view = view_of(layout, canvas)
    pose = None if joints is None else pose_of(layout, joints)
    if rows >= _ROOMY_ROWS:
        _draw_limits(canvas, view, layout, pose)
    _draw_base(canvas, view, layout)
    for reflector in layout.reflectors:
        _draw_reflector(canvas, view, reflector, aimed=reflector.name == layout.aim)
    if pose is not None:
        _draw_beam(canvas, view, layout, pose, beam_ok)
        _draw_arm(canvas, view, pose)
    _write_scale(canvas, view)
    return canvas


def _draw_base(canvas: Canvas, view: View, layout: Layout) -> None:
    canvas.circle(view.dot(0.0, 0.0), layout.column_radius_mm / view.mm_per_dot, BASE)


def _draw_arm(canvas: Canvas, view: View, pose: Pose) -> None:
    base, elbow, place = view.dot(0.0, 0.0), view.dot(*pose.elbow_mm), view.dot(*pose.place_mm)
    canvas.line(base, elbow, ARM)
    canvas.line(elbow, place, ARM)
    canvas.circle(elbow, 1.5, ARM)
    canvas.circle(place, 1.5, ARM)


def _draw_beam(canvas: Canvas, view: View, layout: Layout, pose: Pose, beam_ok: bool | None) -> None:
    """Draw the beam to the reflector that it is meant for, else to the edge; one that is lost is dashed."""
    length_mm = _beam_length_mm(layout, pose) or (canvas.width + canvas.height) * view.mm_per_dot
    ink = {True: BEAM_OK, False: BEAM_LOST, None: BEAM_UNKNOWN}[beam_ok]
    x_mm, y_mm = pose.place_mm
    end = view.dot(x_mm + length_mm * math.cos(pose.beam_rad), y_mm + length_mm * math.sin(pose.beam_rad))
    canvas.line(view.dot(x_mm, y_mm), end, ink, 0 if beam_ok else _DASH)


def _beam_length_mm(layout: Layout, pose: Pose) -> float | None:
    reflector = layout.aimed
    if reflector is None:
        return None
    return math.hypot(reflector.x_mm - pose.place_mm[0], reflector.y_mm - pose.place_mm[1])


def _draw_reflector(canvas: Canvas, view: View, reflector: ReflectorPlace, *, aimed: bool) -> None:
    """Draw a reflector's place, and the arc from which it sends a beam back."""
    ink = AIMED if aimed else REFLECTOR
    x, y = view.dot(reflector.x_mm, reflector.y_mm)
    facing_rad = math.radians(reflector.facing_deg)
    half_rad = math.radians(reflector.field_half_angle_deg)
    canvas.arc((x, y), _FIELD_MM / view.mm_per_dot, facing_rad - half_rad, facing_rad + half_rad, ink, 1)
    canvas.points(np.array([x, x + 1.0, x, x + 1.0]), np.array([y, y, y + 1.0, y + 1.0]), ink)
    column, row = round(x) // 2 + 2, round(y) // 4
    canvas.text(column, row, f"{'►' if aimed else ''}{reflector.name}", ink)


def _draw_limits(canvas: Canvas, view: View, layout: Layout, pose: Pose | None) -> None:
    """Draw the ranges of J1 about the base and of J2 about the elbow."""
    limits = layout.limits_deg
    first_mm = layout.column_radius_mm + 0.2 * layout.link1_mm
    _draw_range(canvas, view, (0.0, 0.0), first_mm, limits["j1"], 0.0)
    if pose is not None:
        second_mm = 0.45 * layout.link2_mm
        _draw_range(canvas, view, pose.elbow_mm, second_mm, limits["j2"], pose.link1_rad)
        _draw_range(canvas, view, pose.place_mm, 0.3 * layout.link2_mm, limits["j4"], pose.link2_rad)


def _draw_range(
    canvas: Canvas,
    view: View,
    centre_mm: tuple[float, float],
    radius_mm: float,
    limits_deg: tuple[float, float],
    zero_rad: float,
) -> None:
    low_deg, high_deg = limits_deg
    if high_deg - low_deg < _TURN_DEG:
        low, high = zero_rad + math.radians(low_deg), zero_rad + math.radians(high_deg)
        canvas.arc(view.dot(*centre_mm), radius_mm / view.mm_per_dot, low, high, RANGE, 2)


def _write_scale(canvas: Canvas, view: View) -> None:
    """Draw a length that fits into a fifth of the width, and write where the axes point."""
    fits = (each for each in _LENGTHS_MM if each / view.mm_per_dot <= canvas.width / 5.0)
    if (length_mm := next(fits, None)) is not None:
        end, y = length_mm / view.mm_per_dot, canvas.height - 2.0
        for start, finish in (
            ((0.0, y), (end, y)),
            ((0.0, y - 1), (0.0, y + 1)),
            ((end, y - 1), (end, y + 1)),
        ):
            canvas.line(start, finish, WORD)
        canvas.text(round(end) // 2 + 2, canvas.rows - 1, f"{length_mm} mm", WORD)
    canvas.text(0, 0, "↑Y →X", WORD)
