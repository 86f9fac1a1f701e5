"""Lines, arcs and circles that a path file draws, and the rows that they stand for."""

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Literal, Self

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, model_validator

from catseye.calibration.kinematics.errors import KinematicsError
from catseye.calibration.kinematics.plane_curves import Arc, circle_through, turned_rad
from catseye.procedures.kit.columns import Columns

Floats = NDArray[np.float64]

STEP_MM = 10.0
"""Largest distance between points where a segment states neither points nor a step."""

MOST_POINTS = 100_000
"""Of a segment: a path of more was drawn in another unit."""

_SAME_MM = 1e-3
"""Places of a drawing are rounded: nearer ones are the same, and radii that differ by less are equal."""

_HALF_TURN_RAD = 1e-6

Number = Annotated[float, Field(allow_inf_nan=False)]
Place = Annotated[list[Number], Field(min_length=2, max_length=2)]
"""x and y in mm."""

Along = Number | Annotated[list[Number], Field(min_length=2, max_length=2)]
"""One value for the whole segment, or those at its beginning and its end."""

Sense = Literal["counter-clockwise", "clockwise"]


class _Segment(BaseModel):
    """What every kind of segment states.

    Attributes:
        points: rows that it makes, both ends included.
        step_mm: largest distance between them, in its place.
        speed_mm_s: along it, for programs that drive it; a measurement stands still at each point.
        z_mm: height, as J3 counts it.
        c_deg: orientation of the tool in the world, deg.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    points: Annotated[int, Field(ge=2, le=MOST_POINTS)] | None = None
    step_mm: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    speed_mm_s: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    z_mm: Along | None = None
    c_deg: Along | None = None

    def share(self, length_mm: float) -> Floats:
        """Return where the points lie, as shares 0...1 of the way along a segment."""
        count = self.points or max(2, math.ceil(length_mm / (self.step_mm or STEP_MM) - 1e-9) + 1)
        return np.linspace(0.0, 1.0, count)

    def _require_points(self, length_mm: float) -> None:
        if self.points is not None and self.step_mm is not None:
            raise ValueError("points and step_mm both say how many points there are: give one of them")
        if self.points is None and length_mm / (self.step_mm or STEP_MM) > MOST_POINTS:
            raise ValueError(
                f"it is {length_mm:g} mm long and would have more than {MOST_POINTS} points: give points or a larger "
                "step_mm, or see whether its places are in mm"
            )


class LineSegment(_Segment):
    """A straight line."""

    kind: Literal["line"]
    from_: Place = Field(alias="from")
    to: Place

    @model_validator(mode="after")
    def _has_length(self) -> Self:
        if _same(self.from_, self.to):
            raise ValueError("from and to are the same place: a line needs two different ends")
        self._require_points(math.dist(self.from_, self.to))
        return self

    def places_mm(self) -> Floats:
        """Return its points, mm, shape (n, 2)."""
        share = self.share(math.dist(self.from_, self.to))[:, None]
        return np.asarray((1.0 - share) * np.array(self.from_) + share * np.array(self.to), dtype=np.float64)


class ArcSegment(_Segment):
    """An arc about a centre, the shorter way unless a sense is given, or through a place between its ends."""

    kind: Literal["arc"]
    from_: Place = Field(alias="from")
    to: Place
    centre: Place | None = None
    via: Place | None = None
    sense: Sense | None = None

    @model_validator(mode="after")
    def _is_one_arc(self) -> Self:
        if (self.centre is None) == (self.via is None):
            raise ValueError("an arc needs either centre or via, a place between its ends")
        if _same(self.from_, self.to):
            raise ValueError('from and to are the same place: take kind = "circle" for a whole turn')
        if self.via is not None and self.sense is not None:
            raise ValueError("via says which way round already: omit sense")
        self._require_points(self.arc().length_mm)
        return self

    def arc(self) -> Arc:
        """Return the arc itself."""
        start, end = np.array(self.from_), np.array(self.to)
        if self.via is not None:
            return _through(start, np.array(self.via), end)
        centre = np.array(self.centre)
        radii = [float(np.hypot(*(place - centre))) for place in (start, end)]
        if abs(radii[0] - radii[1]) > _SAME_MM:
            raise ValueError(
                f"from lies {radii[0]:g} mm and to {radii[1]:g} mm from centre: both have to lie on one circle; "
                "correct centre, or give via instead of it"
            )
        if radii[0] <= _SAME_MM:
            raise ValueError("centre lies on from: an arc needs a radius")
        turned = turned_rad(centre, start, end)
        if self.sense is None and abs(turned - np.pi) <= _HALF_TURN_RAD:
            raise ValueError('half a circle goes either way: give sense = "counter-clockwise" or "clockwise"')
        left = turned < np.pi if self.sense is None else self.sense == "counter-clockwise"
        return Arc(centre, start, turned if left else turned - 2.0 * np.pi, radii[1])

    def places_mm(self) -> Floats:
        """Return its points, mm, shape (n, 2)."""
        arc = self.arc()
        return arc.at(self.share(arc.length_mm))


class CircleSegment(_Segment):
    """A whole circle: about a centre, counter-clockwise unless a sense is given, or through three places."""

    kind: Literal["circle"]
    centre: Place | None = None
    from_: Place | None = Field(None, alias="from")
    radius_mm: Annotated[float, Field(gt=0.0, allow_inf_nan=False)] | None = None
    via: Place | None = None
    to: Place | None = None
    sense: Sense | None = None

    @model_validator(mode="after")
    def _is_one_circle(self) -> Self:
        given = {
            name for name in ("centre", "from_", "radius_mm", "via", "to") if getattr(self, name) is not None
        }
        if given not in ({"centre", "from_"}, {"centre", "radius_mm"}, {"from_", "via", "to"}):
            raise ValueError(
                "a circle needs centre and from, its first point, or centre and radius_mm, or from, via and to, "
                "three places on it"
            )
        if self.via is not None and self.sense is not None:
            raise ValueError("via says which way round already: omit sense")
        self._require_points(self.arc().length_mm)
        return self

    def arc(self) -> Arc:
        """Return the whole turn."""
        if self.centre is None:
            start, via, other = (np.array(place) for place in (self.from_, self.via, self.to))
            centre, sign = _circle(start, via, other)
        else:
            centre = np.array(self.centre)
            sign = -1 if self.sense == "clockwise" else 1
            start = centre + np.array([self.radius_mm, 0.0]) if self.from_ is None else np.array(self.from_)
        radius = float(np.hypot(*(start - centre)))
        if radius <= _SAME_MM:
            raise ValueError("centre lies on from: a circle needs a radius")
        return Arc(centre, start, sign * 2.0 * np.pi, radius)

    def places_mm(self) -> Floats:
        """Return its points, the first one again at the end, mm, shape (n, 2)."""
        arc = self.arc()
        return arc.at(self.share(arc.length_mm))


Segment = Annotated[LineSegment | ArcSegment | CircleSegment, Field(discriminator="kind")]


class DrawnPath(BaseModel):
    """A path file in TOML; a segment that begins where the one before it ends goes on with its line."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True)

    format: Literal["catseye-path/1"] = "catseye-path/1"
    segment: Annotated[list[Segment], Field(min_length=1, max_length=1000)]

    @model_validator(mode="after")
    def _tool_is_known_throughout(self) -> Self:
        for name in ("z_mm", "c_deg"):
            stated = [getattr(segment, name) is not None for segment in self.segment]
            if any(stated) and not all(stated):
                raise ValueError(
                    f"segment {stated.index(False) + 1}: {name} is missing, and other segments state it: state it "
                    "for each, or for none"
                )
        return self

    def columns(self) -> Columns:
        """Return the points of all segments as rows of a path CSV; `lines` holds the segment of each."""
        places = [segment.places_mm() for segment in self.segment]
        sizes = [len(one) for one in places]
        x_mm, y_mm = np.vstack(places).T
        values = {"line": np.repeat(_lines(places), sizes).astype(np.float64), "x_mm": x_mm, "y_mm": y_mm}
        for name in ("z_mm", "c_deg", "speed_mm_s"):
            given = [getattr(segment, name) for segment in self.segment]
            if any(value is not None for value in given):
                values[name] = np.concatenate([_along(*one) for one in zip(given, sizes, strict=True)])
        return Columns(values, np.repeat(np.arange(1, len(sizes) + 1), sizes), counted="segment")


def _lines(places: Sequence[Floats]) -> list[int]:
    """Return the number of the line that each segment belongs to."""
    numbers = [1]
    for before, after in pairwise(places):
        numbers.append(numbers[-1] + (0 if _same(before[-1], after[0]) else 1))
    return numbers


def _along(value: float | list[float] | None, count: int) -> Floats:
    """Return a quantity at each point of a segment, NaN where the segment does not state it."""
    first, last = value if isinstance(value, list) else (value, value)
    return np.linspace(math.nan if first is None else first, math.nan if last is None else last, count)


def _through(start: Floats, via: Floats, end: Floats) -> Arc:
    centre, sign = _circle(start, via, end)
    turned = turned_rad(centre, start, end)
    return Arc(centre, start, turned if sign > 0 else turned - 2.0 * np.pi, float(np.hypot(*(end - centre))))


def _circle(start: Floats, via: Floats, end: Floats) -> tuple[Floats, int]:
    try:
        return circle_through(start, via, end)
    except KinematicsError as error:
        raise ValueError(
            'via lies on the line through from and to, so that it fixes no circle: take kind = "line", or a via '
            "beside that line"
        ) from error


def _same(one: Sequence[float] | Floats, other: Sequence[float] | Floats) -> bool:
    return math.dist(one, other) <= _SAME_MM
