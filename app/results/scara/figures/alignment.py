"""What the rounds of an alignment measured: lengths against J4 with their slope, heights with the beam's pitch."""

from dataclasses import dataclass
from typing import Final

import numpy as np

from catseye.app.results.figures import Axis, Band, Dash, Figure, Ink, Level, Line, Mark, Panel, Points, Role
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.alignment import PitchFit
from catseye.procedures.kit.expanded import expanded_text

_FIRST: Final = Role.MUTED
_LAST: Final = Role.CHANGE
_DRAWN: Final = 61


@dataclass(frozen=True)
class TurnRound:
    """Lengths while J4 turned through the return, and what was fitted to them.

    Attributes:
        number: of the round.
        turn_deg: J4 from the middle of the return, shape (n,).
        length_mm: displacements there, shape (n,).
        series: number of the pass that each belongs to, shape (n,).
        offset_mm: fitted slope, which is the offset of the beam from the axis, mm/rad.
        curvature_mm: fitted curvature, mm/rad².
    """

    number: int
    turn_deg: Floats
    length_mm: Floats
    series: Ints
    offset_mm: float
    curvature_mm: float

    @property
    def length_um(self) -> Floats:
        """Lengths from the fitted one in the middle, each pass on its own."""
        turn = np.deg2rad(self.turn_deg)
        fitted = self.offset_mm * turn + self.curvature_mm * turn**2
        from_fit = self.length_mm - fitted
        for number in np.unique(self.series):
            from_fit[self.series == number] -= from_fit[self.series == number].mean()
        return 1e3 * (from_fit + fitted)

    def bend_um(self, turn_deg: Floats) -> Floats:
        """Return the fitted curvature's part: it is that of a straight beam turned about J4."""
        return 1e3 * self.curvature_mm * np.deg2rad(turn_deg) ** 2

    def slope_um(self, turn_deg: Floats) -> Floats:
        """Return the fitted slope's part."""
        return 1e3 * self.offset_mm * np.deg2rad(turn_deg)


def turns_figure(first: TurnRound, last: TurnRound, tolerance_mm: float) -> Figure:
    """Return the last round as it was measured, and what is left of first and last without the bend.

    Args:
        first: the first round; may be the last as well.
        tolerance_mm: largest accepted size of the offset.
    """
    span = float(np.max(np.abs(last.turn_deg)))
    turn = np.linspace(-span, span, _DRAWN)
    fitted = last.bend_um(turn) + last.slope_um(turn)
    measured = Panel(
        f"round {last.number}",
        Axis("J4 from the middle of the return / °"),
        Axis("length / µm"),
        (Level(0.0, Role.AXIS), *_passes(last, last.length_um), Line(turn, fitted, Role.CHOSEN, "fit")),
    )
    limits = tuple(
        Line(turn, sign * 1e3 * tolerance_mm * np.deg2rad(turn), Role.EXPECTED, "tolerance", dash="dashed")
        for sign in (-1.0, 1.0)
    )
    before = () if first.number == last.number else _left(first, turn, _FIRST, "o", "dotted")
    left = Panel(
        "without the bend: the slope is the offset",
        Axis("J4 from the middle of the return / °"),
        Axis("length / µm"),
        (Level(0.0, Role.AXIS), *limits, *before, *_left(last, turn, _LAST, "D", "solid")),
    )
    caption = (
        "Length while J4 turns through the return. It bends as a beam of this length must; its slope in the middle "
        "is the offset of the beam from the J4 axis."
    )
    return Figure("beam-to-j4", "Length against J4", caption, ((measured, left),), aspect=0.42)


def _passes(taken: TurnRound, length_um: Floats) -> list[Mark]:
    looks: tuple[tuple[int, Ink, str], ...] = (
        (0, Role.POSITIVE, "J4 upwards"),
        (1, Role.NEGATIVE, "J4 downwards"),
    )
    return [
        Points(taken.turn_deg[own], length_um[own], ink, label, size=3.5)
        for parity, ink, label in looks
        if (own := taken.series % 2 == parity).any()
    ]


def _left(taken: TurnRound, turn: Floats, ink: Ink, marker: str, dash: Dash) -> list[Mark]:
    name = f"round {taken.number}: {taken.offset_mm:+.3f} mm"
    left = taken.length_um - taken.bend_um(taken.turn_deg)
    return [
        Points(taken.turn_deg, left, ink, name, marker=marker, hollow=marker == "o", size=3.5),
        Line(turn, taken.slope_um(turn), ink, dash=dash),
    ]


@dataclass(frozen=True)
class HeightRound:
    """Heights of J3 in the middle of the return, and the line through them.

    Attributes:
        number: of the round.
        distance_mm: from the J4 axis to the reflector, shape (n,).
        j3_mm: heights there, shape (n,).
        fit: pitch and height of the beam.
        u_mm: standard uncertainty of a height.
    """

    number: int
    distance_mm: Floats
    j3_mm: Floats
    fit: PitchFit
    u_mm: float


def heights_figure(first: HeightRound, last: HeightRound, tolerance_mrad: float) -> Figure:
    """Return heights against distance before and after, with what the tolerance leaves the last round.

    Args:
        first: the first round; may be the last as well.
        tolerance_mrad: largest accepted size of the pitch.
    """
    low, high = float(last.distance_mm.min()), float(last.distance_mm.max())
    distance = np.linspace(low, high, _DRAWN)
    middle = 0.5 * (low + high)
    room = 1e-3 * tolerance_mrad * np.abs(distance - middle)
    level = last.fit.height_mm(middle)
    band = Band(distance, level - room, level + room, Role.EXPECTED, f"within ±{tolerance_mrad:g} mrad")
    before = [] if first.number == last.number else _heights(first, distance, _FIRST, "o", "dotted")
    marks = (band, *before, *_heights(last, distance, _LAST, "D", "solid"))
    panel = Panel("heights", Axis("distance to the reflector / mm"), Axis("J3 / mm"), marks)
    caption = (
        "Height of J3 at which the beam meets the reflector, from near and far (error bars: U (k = 2)): the slope of "
        "the line is the pitch of the beam, downwards where the beam rises."
    )
    return Figure("heights", "Height against distance", caption, ((panel,),), aspect=0.42)


def _heights(taken: HeightRound, distance: Floats, ink: Ink, marker: str, dash: Dash) -> list[Mark]:
    pitch_mrad, u_mrad = 1e3 * taken.fit.pitch_rad, 1e3 * taken.fit.u_pitch_rad
    line = taken.fit.axis_height_mm - taken.fit.pitch_rad * distance
    u = np.full(taken.j3_mm.size, taken.u_mm)
    name = f"round {taken.number}: pitch {expanded_text(pitch_mrad, u_mrad, 3, signed=True)} mrad (k = 2)"
    return [
        Line(distance, line, ink, dash=dash),
        Points(taken.distance_mm, taken.j3_mm, ink, name, u, marker=marker, hollow=marker == "o"),
    ]
