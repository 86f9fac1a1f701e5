"""What a place sees, against plane geometry."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.design.sight import Rules, Way, best_facing, sight_of

RULES = Rules(
    column_radius_mm=115.0,
    field_half_angle_rad=float(np.deg2rad(80.0)),
    beam_range_mm=(50.0, 5000.0),
    j4_limits_rad=(-2.0 * np.pi, 2.0 * np.pi),
    theta40_rad=0.0,
    keep_out_mm=600.0,
    apart_mm=100.0,
    fewest_seen=0.8,
    most_breaks=4,
)


def circle(first_deg: float, last_deg: float, radius_mm: float = 300.0, samples: int = 181) -> Way:
    """Return a straight arm of that length that turns about J1; every tenth sample is a command."""
    angle = np.deg2rad(np.linspace(first_deg, last_deg, samples))
    xy = radius_mm * np.column_stack([np.cos(angle), np.sin(angle)])
    return Way(np.column_stack([angle, np.zeros(samples)]), xy, np.arange(0, samples, 10))


@given(st.floats(-10.0, 10.0), st.lists(st.floats(0.0, 2.7), min_size=1, max_size=20))
def test_a_field_that_is_wide_enough_holds_everything(turn: float, spread: list[float]) -> None:
    directions = turn + np.array(spread)
    facing = best_facing(directions, np.deg2rad(80.0))
    away = np.abs(np.angle(np.exp(1j * (directions - facing))))
    assert away.max() <= np.deg2rad(80.0) + 1e-9


def test_a_field_that_is_too_narrow_looks_where_most_is() -> None:
    directions = np.deg2rad([0.0, 10.0, 20.0, 180.0, 355.0])
    assert np.rad2deg(best_facing(directions, np.deg2rad(20.0))) == pytest.approx(7.5)


def test_a_reflector_in_the_open_sees_everything_from_one_segment() -> None:
    sight = sight_of(np.array([700.0, 0.0]), circle(-60.0, 60.0), RULES)
    assert sight.reason == ""
    assert sight.seen.all()
    assert (sight.segments, sight.breaks) == (1, 0)
    assert np.rad2deg(sight.facing_rad) == pytest.approx(180.0, abs=1e-6)


def test_the_column_hides_what_lies_behind_it() -> None:
    way = circle(0.0, 360.0, samples=3601)
    sight = sight_of(np.array([700.0, 0.0]), way, RULES)
    polar = np.deg2rad(np.linspace(0.0, 360.0, 3601))[::10]
    hidden = np.abs(np.angle(np.exp(1j * (polar - np.pi)))) < _half_shadow(700.0, 300.0, 115.0)
    assert np.array_equal(~sight.seen, hidden)


def _half_shadow(place_mm: float, radius_mm: float, column_mm: float) -> float:
    """Return the half angle of the circle's arc behind the column, by the tangent from the place."""
    slope = np.arcsin(column_mm / place_mm)
    along = place_mm * np.cos(slope) + np.sqrt(radius_mm**2 - column_mm**2)
    x, y = place_mm - along * np.cos(slope), along * np.sin(slope)
    return float(np.pi - np.arctan2(y, x))


def test_a_shadow_breaks_the_beam_and_begins_a_segment() -> None:
    sight = sight_of(np.array([700.0, 0.0]), circle(90.0, 270.0), RULES)
    assert sight.breaks == 1
    assert sight.segments == 2
    assert set(sight.segment[sight.seen]) == {0, 1}


def test_a_segment_of_two_distances_brings_nothing() -> None:
    way = circle(90.0, 270.0)
    few = Way(way.theta_rad, way.xy_mm, np.array([0, 5, 10, 15, 20, 175, 180]))
    sight = sight_of(np.array([700.0, 0.0]), few, RULES)
    assert sight.segments == 1
    assert sight.breaks == 1
    assert list(sight.segment) == [0, 0, 0, 0, 0, -1, -1]


@pytest.mark.parametrize(
    ("place", "way", "reason"),
    [
        ((500.0, 0.0), circle(-60.0, 60.0), "inside the keep-out radius"),
        ((620.0, 0.0), circle(-60.0, 60.0, 600.0), "in the arm's way"),
        ((-700.0, 0.0), circle(-25.0, 25.0), "seen from too few commands"),
    ],
)
def test_why_a_place_is_excluded(place: tuple[float, float], way: Way, reason: str) -> None:
    assert sight_of(np.array(place), way, RULES).reason == reason


def test_a_way_round_the_axis_winds_j4_up() -> None:
    """One turn of J1 with the beam's world angle swinging back and forth turns J4 back by one turn."""
    narrow = Rules(**{**RULES.__dict__, "column_radius_mm": 0.0, "j4_limits_rad": (-3.1, 3.1)})
    wide = Rules(**{**RULES.__dict__, "column_radius_mm": 0.0})
    place = np.array([0.0, 5000.0 / 8.0])
    assert sight_of(place, circle(0.0, 360.0), narrow).reason == "J4 winds up"
    assert sight_of(place, circle(0.0, 360.0), wide).reason == ""


def test_a_beam_that_is_broken_too_often() -> None:
    turns: Floats = np.concatenate([circle(90.0, 270.0).theta_rad] * 3)
    xy = np.concatenate([circle(90.0, 270.0).xy_mm, circle(270.0, 90.0).xy_mm, circle(90.0, 270.0).xy_mm])
    way = Way(turns, xy, np.arange(0, len(xy), 10))
    rules = Rules(**{**RULES.__dict__, "most_breaks": 2, "fewest_seen": 0.3})
    assert sight_of(np.array([700.0, 0.0]), way, rules).reason == "beam breaks too often"
