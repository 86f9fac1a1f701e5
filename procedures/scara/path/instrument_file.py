"""Positions in a file that a tracker's own program wrote: which columns they are in, and how its frame stands."""

from collections.abc import Mapping
from typing import Annotated, Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError

from catseye.procedures.kit.columns import Columns, DocumentRule
from catseye.procedures.kit.errors import TableFileError
from catseye.procedures.kit.mapping import FORMAT, LENGTHS, MappedColumn, MappedColumns, TableMapping

Floats = NDArray[np.float64]

POSITIONS: Final = DocumentRule("a mapping of a tracker's file", FORMAT)

_MOST_TILT_DEG: Final = 30.0
"""A tracker on a stand that nobody has levelled is tilted by less."""

_MOST_OFF: Final = 0.02
"""Nothing that moves in a plane is seen farther off it, as a share of how far it is spread."""

_STRAIGHT: Final = 0.01
"""Points that are spread less than this share across a line make out no plane."""

IN_ONE_PLACE: Final = (
    "all positions lie in one place, so the frames cannot be aligned: measure positions spread out"
)

_LARGEST_U_MM: Final = 1.0
"""An instrument with a larger uncertainty would say nothing about an error map."""


class PositionColumns(MappedColumns):
    """Columns of positions: of a right-handed frame, whose z points upwards."""

    units: ClassVar[Mapping[str, Mapping[str, float]]] = dict.fromkeys(
        ("x_meas_mm", "y_meas_mm", "z_meas_mm", "u_mm"), LENGTHS
    )
    x_meas_mm: MappedColumn
    y_meas_mm: MappedColumn
    z_meas_mm: MappedColumn | None = None
    u_mm: MappedColumn | None = None


class PositionsMapping(TableMapping):
    """A whole mapping file of positions."""

    u_mm: Annotated[float, Field(gt=0.0, le=_LARGEST_U_MM)] | None = None
    columns: PositionColumns


def mapping_of(document: Mapping[str, Any]) -> PositionsMapping:
    """Return the mapping that a document states.

    Raises:
        ValueError: it states none of positions; names each key.
    """
    try:
        return PositionsMapping.model_validate(document)
    except ValidationError as error:
        faults = (f"{'.'.join(map(str, one['loc']))}: {one['msg']}" for one in error.errors())
        raise ValueError("; ".join(faults)) from error


def positions_in_plane(file: str, measured: Columns, mapping: PositionsMapping) -> Columns:
    """Return x and y of positions in the plane that the arm moves in, with their uncertainty where it is known.

    With z the frame need not be level: the plane is that of the points. Without it x and y are taken as they are.

    Raises:
        TableFileError: all positions lie in one place, z is not the coordinate that points upwards, or uncertainties
            cannot be; says what to change.
    """
    values = {name: measured[name] for name in ("x_meas_mm", "y_meas_mm")}
    if not are_spread(measured.stacked(("x_meas_mm", "y_meas_mm"))):
        raise TableFileError(f"{file}: {IN_ONE_PLACE}")
    if "z_meas_mm" in measured:
        place = measured.stacked(("x_meas_mm", "y_meas_mm", "z_meas_mm"))
        flat = levelled(place, _normal(file, place))
        values = {"x_meas_mm": flat[:, 0], "y_meas_mm": flat[:, 1]}
    if "u_mm" in measured:
        values["u_mm"] = _uncertainty(file, measured)
    elif mapping.u_mm is not None:
        values["u_mm"] = np.full(len(measured), mapping.u_mm)
    return Columns(values, measured.lines)


def are_spread(place_mm: Floats, farther_than_mm: float = 0.0) -> bool:
    """Return whether places lie farther apart than this along any axis; shape (n, 2) or (n, 3)."""
    return bool(np.any(np.ptp(place_mm, axis=0) > farther_than_mm))


def levelled(place_mm: Floats, normal: Floats) -> Floats:
    """Return places by two axes across a normal, the first one as near to x as it can be, shape (n, 2).

    Args:
        place_mm: x, y and z, shape (n, 3).
        normal: unit vector, shape (3,).
    """
    first = np.array([1.0, 0.0, 0.0]) - normal[0] * normal
    first /= np.linalg.norm(first)
    return np.asarray(place_mm @ np.column_stack([first, np.cross(normal, first)]))


def plane_normal(place_mm: Floats) -> Floats:
    """Return the upward unit normal of the plane through places, shape (3,).

    Places on one line say nothing of the tilt across it, which then counts as none; nor does a single place.
    """
    up = np.array([0.0, 0.0, 1.0])
    if not are_spread(place_mm):
        return up
    _, spread, axes = np.linalg.svd(place_mm - place_mm.mean(axis=0), full_matrices=False)
    if spread[1] < _STRAIGHT * spread[0]:
        normal = up - axes[0, 2] * axes[0]
        return np.asarray(normal / np.linalg.norm(normal)) if np.linalg.norm(normal) > 0.0 else up
    return np.asarray(axes[2] if axes[2, 2] >= 0.0 else -axes[2])


def tilt_deg(normal: Floats) -> float:
    """Return the angle between a normal and z."""
    return float(np.degrees(np.arccos(np.clip(normal[2], -1.0, 1.0))))


def _normal(file: str, place_mm: Floats) -> Floats:
    normal = plane_normal(place_mm)
    if (tilt := tilt_deg(normal)) > _MOST_TILT_DEG:
        raise TableFileError(
            f"{file}: the points lie in a plane that is tilted by {tilt:.0f}° against x and y of the mapping: "
            "z_meas_mm has to be the coordinate that points upwards, x_meas_mm and y_meas_mm the two others; correct "
            "the columns of the mapping"
        )
    away = place_mm - place_mm.mean(axis=0)
    off = np.abs(away @ normal)
    if off.max() > _MOST_OFF * np.linalg.norm(away, axis=1).max():
        raise TableFileError(
            f"{file}: the points lie up to {off.max():.3g} mm off one plane: z_meas_mm is another column, or the "
            "path changes its height; for such a path level the frame in the tracker's program, and leave z_meas_mm "
            "out of the mapping"
        )
    return normal


def _uncertainty(file: str, measured: Columns) -> Floats:
    u_mm = measured["u_mm"]
    wrong = (u_mm <= 0.0) | (u_mm > _LARGEST_U_MM)
    if wrong.any():
        row = int(np.argmax(wrong))
        raise TableFileError(
            f"{file}:{measured.lines[row]}: u_mm = {u_mm[row]:g} mm by the mapping, and has to be above 0 and at "
            f"most {_LARGEST_U_MM:g}: correct its column or unit in the mapping, or leave it out"
        )
    return u_mm
