"""Segments of a path file against geometry with complex numbers."""

import cmath
import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from catseye.procedures.kit.columns import Columns
from catseye.procedures.scara.path.segments import DrawnPath


def drawn(*segments: dict[str, Any]) -> Columns:
    return DrawnPath.model_validate({"segment": list(segments)}).columns()


def places(*segments: dict[str, Any]) -> list[complex]:
    columns = drawn(*segments)
    return [complex(x, y) for x, y in columns.stacked(("x_mm", "y_mm"))]


def turns_rad(points: list[complex], centre: complex) -> list[float]:
    """Return the angle from each point to the next about a centre."""
    return [cmath.phase((b - centre) / (a - centre)) for a, b in pairwise(points)]


def xy(place: complex) -> list[float]:
    return [place.real, place.imag]


def test_a_line_has_equally_spaced_points_with_exact_ends() -> None:
    points = places({"kind": "line", "from": [200.0, -400.0], "to": [200, 100], "points": 6})
    assert points == pytest.approx([200 + 1j * y for y in range(-400, 101, 100)], abs=1e-12)
    assert (points[0], points[-1]) == (200 - 400j, 200 + 100j)


def test_a_step_bounds_the_distance_between_points() -> None:
    segment = {"kind": "line", "from": [0.0, 300.0], "to": [95.0, 300.0]}
    assert len(places(segment)) == 11
    assert len(places({**segment, "step_mm": 30.0})) == 5
    assert len(places({**segment, "step_mm": 1000.0})) == 2


@given(
    centre=st.complex_numbers(max_magnitude=400.0),
    radius=st.floats(5.0, 500.0),
    start=st.floats(-math.pi, math.pi),
    sweep=st.floats(0.2, 2.0 * math.pi - 0.2) | st.floats(-2.0 * math.pi + 0.2, -0.2),
    share=st.floats(0.2, 0.8),
)
def test_an_arc_through_a_place_keeps_radius_and_sense(
    centre: complex, radius: float, start: float, sweep: float, share: float
) -> None:
    def at(part: float) -> complex:
        return centre + cmath.rect(radius, start + part * sweep)

    points = places(
        {"kind": "arc", "from": xy(at(0.0)), "via": xy(at(share)), "to": xy(at(1.0)), "points": 201}
    )
    for number, point in enumerate(points):
        assert abs(point - at(number / 200)) < 1e-8
    assert abs(points[0] - at(0.0)) < 1e-9
    assert abs(points[-1] - at(1.0)) < 1e-9
    assert all(turn * sweep > 0.0 for turn in turns_rad(points, centre))


def test_points_of_an_arc_lie_on_its_radius() -> None:
    points = places(
        {"kind": "arc", "from": [300.0, 0.0], "to": [0.0, 300.0], "centre": [0.0, 0.0], "points": 50}
    )
    assert max(abs(abs(point) - 300.0) for point in points) < 1e-9
    assert sum(turns_rad(points, 0j)) == pytest.approx(math.pi / 2.0, abs=1e-12)


@pytest.mark.parametrize(
    ("sense", "turned_deg"), [(None, -90.0), ("clockwise", -90.0), ("counter-clockwise", 270.0)]
)
def test_an_arc_about_a_centre_takes_the_shorter_way(sense: str | None, turned_deg: float) -> None:
    segment = {
        "kind": "arc",
        "from": [300.0, 100.0],
        "to": [200.0, 0.0],
        "centre": [200.0, 100.0],
        "points": 9,
    }
    points = places(segment if sense is None else {**segment, "sense": sense})
    assert math.degrees(sum(turns_rad(points, 200 + 100j))) == pytest.approx(turned_deg)


@pytest.mark.parametrize(
    ("keys", "first", "turned_deg"),
    [
        ({"centre": [250.0, 50.0], "from": [250.0, 150.0]}, 250 + 150j, 360.0),
        ({"centre": [250.0, 50.0], "radius_mm": 100.0}, 350 + 50j, 360.0),
        ({"centre": [250.0, 50.0], "radius_mm": 100.0, "sense": "clockwise"}, 350 + 50j, -360.0),
        ({"from": [350.0, 50.0], "via": [250.0, -50.0], "to": [150.0, 50.0]}, 350 + 50j, -360.0),
    ],
)
def test_a_circle_closes_at_its_first_point(keys: dict[str, Any], first: complex, turned_deg: float) -> None:
    points = places({"kind": "circle", "points": 37, **keys})
    assert points[0] == pytest.approx(first)
    assert points[-1] == pytest.approx(first)
    assert max(abs(abs(point - (250 + 50j)) - 100.0) for point in points) < 1e-9
    assert math.degrees(sum(turns_rad(points, 250 + 50j))) == pytest.approx(turned_deg)


def test_connected_segments_go_on_with_their_line() -> None:
    columns = drawn(
        {"kind": "line", "from": [200.0, 0.0], "to": [300.0, 0.0], "points": 2},
        {"kind": "arc", "from": [300.0, 0.0], "via": [350.0, 50.0], "to": [300.0, 100.0], "points": 3},
        {"kind": "line", "from": [200.0, 200.0], "to": [300.0, 200.0], "points": 2},
    )
    assert columns["line"].tolist() == [1, 1, 1, 1, 1, 2, 2]
    assert columns.lines.tolist() == [1, 1, 2, 2, 2, 3, 3]


def test_height_and_orientation_are_kept_or_change_evenly() -> None:
    line = {"kind": "line", "from": [200.0, 0.0], "to": [300.0, 0.0], "points": 3}
    columns = drawn(
        {**line, "z_mm": 40.0, "c_deg": [0.0, 90.0], "speed_mm_s": 25.0},
        {**line, "z_mm": [40, 60], "c_deg": 7},
    )
    assert columns["z_mm"].tolist() == [40, 40, 40, 40, 50, 60]
    assert columns["c_deg"].tolist() == [0, 45, 90, 7, 7, 7]
    np.testing.assert_array_equal(columns["speed_mm_s"], [25.0] * 3 + [np.nan] * 3)


LINE = {"kind": "line", "from": [200.0, 0.0], "to": [300.0, 0.0]}
ARC = {"kind": "arc", "from": [200.0, 0.0], "to": [300.0, 0.0]}


@pytest.mark.parametrize(
    ("segment", "part"),
    [
        ({**LINE, "to": [200.0, 0.0]}, "from and to are the same place"),
        ({**LINE, "points": 0}, "greater than or equal to 2"),
        ({**LINE, "points": 5, "step_mm": 1.0}, "give one of them"),
        ({**LINE, "step_mm": 1e-6}, "more than 100000 points.*in mm"),
        (ARC, "either centre or via"),
        ({**ARC, "centre": [230.0, 0.0]}, "from lies 30 mm and to 70 mm from centre.*one circle"),
        ({**ARC, "centre": [250.0, 0.0]}, "half a circle goes either way: give sense"),
        ({**ARC, "via": [250.0, 0.0]}, 'via lies on the line through from and to.*kind = "line"'),
        ({**ARC, "to": [200.0, 0.0], "via": [250.0, 1.0]}, 'same place: take kind = "circle"'),
        ({**ARC, "via": [250.0, 9.0], "sense": "clockwise"}, "omit sense"),
        ({"kind": "circle", "centre": [200.0, 0.0]}, "a circle needs centre and from"),
        ({"kind": "circle", "centre": [200.0, 0.0], "from": [200.0, 0.0]}, "needs a radius"),
        ({**LINE, "from": [math.nan, 0.0]}, "finite"),
    ],
)
def test_a_segment_that_cannot_be_drawn_is_refused(segment: dict[str, Any], part: str) -> None:
    with pytest.raises(ValidationError, match=part):
        drawn(segment)


def test_a_height_of_some_segments_alone_is_refused() -> None:
    with pytest.raises(ValidationError, match="segment 2: z_mm is missing, and other segments state it"):
        drawn({**LINE, "z_mm": 50.0}, LINE)
