"""Grids of places, fronts of compromises and the compass search, against closed forms."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.core.design.criteria import pareto_front
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.design.candidates import Floor, apart, grid
from catseye.calibration.scara.design.refinement import refine


@pytest.mark.parametrize(
    "floor",
    [
        Floor((-1100.0, 1100.0), (-1100.0, 1100.0), 1100.0),
        Floor((550.0, 900.0), (-600.0, 600.0)),
        Floor((700.0, 700.0), (-600.0, 600.0)),
    ],
)
def test_grid_has_about_as_many_places_as_wanted_outside(floor: Floor) -> None:
    places, spacing = grid(floor, 600.0, 200)
    outside = np.hypot(*places.T) >= 600.0
    assert 200 <= outside.sum() <= 240
    assert floor.holds(places).all()
    gaps = np.hypot(*np.moveaxis(places[:, None] - places[None, :], -1, 0))[~np.eye(len(places), dtype=bool)]
    assert gaps.min() >= spacing - 1.5


def test_a_floor_inside_the_keep_out_radius_ends_with_millimetres() -> None:
    places, _ = grid(Floor((0.0, 10.0), (0.0, 10.0)), 600.0, 100)
    assert len(places) <= 121
    assert not (np.hypot(*places.T) >= 600.0).any()


def test_apart_counts_the_limit_itself() -> None:
    places = np.array([[0.0, 0.0], [60.0, 80.0], [0.0, 99.0]])
    assert apart(places, 100.0).tolist() == [
        [False, True, False],
        [True, False, False],
        [False, False, False],
    ]


@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), min_size=1, max_size=25))
def test_front_is_what_no_other_row_beats(rows: list[tuple[int, int]]) -> None:
    flags = pareto_front(np.array(rows, dtype=float))
    for row, flag in zip(rows, flags, strict=True):
        beaten = any(a <= row[0] and b <= row[1] and (a, b) != row for a, b in rows)
        assert flag == (not beaten)


def test_refinement_finds_the_minimum_of_a_bowl() -> None:
    bottom = np.array([[612.0, -37.0], [701.0, 250.0]])

    def value(places: Floats) -> float:
        return float(np.sum((places - bottom) ** 2 * [1.0, 3.0]))

    places, reached = refine(np.array([[560.0, 20.0], [750.0, 200.0]]), value, 40.0)
    assert np.array_equal(places, bottom)
    assert reached == 0.0


def test_refinement_stays_where_a_constraint_ends() -> None:
    def value(places: Floats) -> float:
        return float(places[0, 0]) if places[0, 0] >= 600.0 else float("inf")

    places, reached = refine(np.array([[650.0, 0.0]]), value, 40.0)
    assert reached == places[0, 0] == 600.0
