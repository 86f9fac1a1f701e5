"""Rows of another program's table as points and poses: which column is what, in which units and which hand. Pure."""

import math
from dataclasses import dataclass
from typing import Final, Literal, TypeAlias

from catseye.drivers.roles.errors import ProtocolError
from catseye.drivers.roles.rotations import as_fixed_axes_deg
from catseye.drivers.roles.text_table import Dialect
from catseye.drivers.roles.tracker import Place

LengthUnit: TypeAlias = Literal["mm", "m", "inch"]
AngleUnit: TypeAlias = Literal["deg", "rad"]
Mirrored: TypeAlias = Literal["none", "x", "y", "z"]
Turns: TypeAlias = Literal["fixed-axes", "moving-axes"]

MM: Final[dict[LengthUnit, float]] = {"mm": 1.0, "m": 1000.0, "inch": 25.4}
DEG: Final[dict[AngleUnit, float]] = {"deg": 1.0, "rad": math.degrees(1.0)}

_OTHER_UNITS: Final = {"m": 1000.0, "inch": 25.4, "mm": 1e-3}
"""What a place has to be multiplied by if the file is in that unit and not in the stated one, roughly."""


@dataclass(frozen=True)
class Columns:
    """Places of the columns in a row, from 1, and what they mean.

    Attributes:
        place: of x, y and z.
        turn: of rx, ry and rz; None in a file of points.
        target: of the target's name; None without one.
        u: of the standard uncertainty of a coordinate; None without one.
        visible: of the number of marks that were seen; None without one.
        base_visible: likewise of the marks on the base.
        length_unit: of coordinates and uncertainty.
        angle_unit: of rotations.
        mirrored: the axis whose sign makes a left-handed frame right-handed.
        turns: R = Rz·Ry·Rx, or R = Rx·Ry·Rz.
    """

    place: tuple[int, int, int]
    turn: tuple[int, int, int] | None = None
    target: int | None = None
    u: int | None = None
    visible: int | None = None
    base_visible: int | None = None
    length_unit: LengthUnit = "mm"
    angle_unit: AngleUnit = "deg"
    mirrored: Mirrored = "none"
    turns: Turns = "fixed-axes"


@dataclass(frozen=True)
class Row:
    """A row.

    Attributes:
        target: name of the target, empty without one.
        place_mm: x, y, z.
        turn_deg: rx, ry, rz with R = Rz·Ry·Rx; None in a file of points.
        u_mm: standard uncertainty of a coordinate; None without one.
        visible: marks that were seen; None without a column.
        base_visible: likewise of the marks on the base.
    """

    target: str
    place_mm: Place
    turn_deg: Place | None
    u_mm: float | None
    visible: int | None = None
    base_visible: int | None = None


def parse_row(line: str, dialect: Dialect, columns: Columns) -> Row:
    """Return what a line says.

    Raises:
        ProtocolError: a column is missing or no number; the text says which.
    """
    try:
        cells = dialect.cells(line)
    except ValueError as error:
        raise ProtocolError(str(error)) from None
    x, y, z = (MM[columns.length_unit] * _number(cells, place, dialect) for place in columns.place)
    u = None if columns.u is None else MM[columns.length_unit] * _number(cells, columns.u, dialect)
    if u is not None and u <= 0.0:
        raise ProtocolError(f"the uncertainty in column {columns.u} is {u:g}, not above 0")
    return Row(
        "" if columns.target is None else _cell(cells, columns.target),
        _right_handed((x, y, z), columns.mirrored),
        None if columns.turn is None else _turn_deg(cells, columns.turn, dialect, columns),
        u,
        None if columns.visible is None else _count(cells, columns.visible, dialect),
        None if columns.base_visible is None else _count(cells, columns.base_visible, dialect),
    )


def likely_mistake(place_mm: Place, near_mm: Place, tolerance_mm: float) -> str:
    """Return what a place that is not where it was expected would be explained by; empty for nothing known."""
    for unit, factor in _OTHER_UNITS.items():
        x, y, z = (factor * value for value in place_mm)
        if math.dist((x, y, z), near_mm) <= tolerance_mm:
            return f"the file seems to be in {unit}: set length_unit"
    for axis in ("x", "y", "z"):
        if math.dist(_right_handed(place_mm, axis), near_mm) <= tolerance_mm:
            return f"the file seems to be in a left-handed frame: set mirrored = {axis!r}"
    return ""


def _right_handed(place_mm: Place, mirrored: Mirrored) -> Place:
    x, y, z = (-value if axis == mirrored else value for axis, value in zip("xyz", place_mm, strict=True))
    return x, y, z


def _turn_deg(cells: list[str], places: tuple[int, int, int], dialect: Dialect, columns: Columns) -> Place:
    """Return rotations; a mirror turns the sense of those about the two other axes."""
    values = [DEG[columns.angle_unit] * _number(cells, place, dialect) for place in places]
    if columns.mirrored != "none":
        values = [
            value if axis == columns.mirrored else -value for axis, value in zip("xyz", values, strict=True)
        ]
    rx, ry, rz = values
    return (rx, ry, rz) if columns.turns == "fixed-axes" else as_fixed_axes_deg((rx, ry, rz))


def _cell(cells: list[str], place: int) -> str:
    if place > len(cells):
        raise ProtocolError(
            f"{len(cells)} columns, but column {place} is wanted: another separator, or a cut row"
        )
    return cells[place - 1]


def _count(cells: list[str], place: int, dialect: Dialect) -> int:
    value = _number(cells, place, dialect)
    if value < 0.0 or value != int(value):
        raise ProtocolError(f"column {place} holds {value:g}, no number of marks: correct the mapping")
    return int(value)


def _number(cells: list[str], place: int, dialect: Dialect) -> float:
    cell = _cell(cells, place)
    try:
        value = dialect.number(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value):
        sign = "comma" if dialect.decimal == "," else "point"
        raise ProtocolError(
            f"column {place} holds {cell!r}, no number with a decimal {sign}: correct the mapping"
        )
    return value
