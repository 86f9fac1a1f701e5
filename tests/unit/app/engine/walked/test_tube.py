"""Whether a motion lies in tubes that were walked, against dense sampling."""

from itertools import pairwise
from random import Random

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from catseye.app.engine.walked.tube import Leg, Tubes, legs_through
from catseye.drivers.roles.pose import Pose
from tests.unit.procedures.benches import scara_axes

AXES = scara_axes()
TOLERANCES = np.array([1.0, 1.0, 5.0, 1.0])

joint = st.floats(-4.0, 4.0, allow_nan=False)
height = st.floats(-20.0, 20.0, allow_nan=False)
places = st.tuples(joint, joint, height, joint)
legs = st.builds(Leg, places, places)
still = places.map(lambda place: Leg(place, place))


def poses(leg: Leg, count: int) -> NDArray[np.float64]:
    share = np.linspace(0.0, 1.0, count)[:, None]
    return np.asarray((1.0 - share) * leg.start + share * leg.end, dtype=np.float64)


def miss(leg: Leg, walked: list[Leg], count: int = 81) -> float:
    """Return by how many tolerances the worst sampled pose misses the nearest sampled pose of what was walked."""
    there = np.vstack([poses(each, count) for each in walked]) / TOLERANCES
    here = poses(leg, count) / TOLERANCES
    return float(np.abs(here[:, None, :] - there[None, :, :]).max(axis=2).min(axis=1).max())


def spacing(walked: list[Leg], count: int = 81) -> float:
    """Return half the largest distance between two samples of a walked motion, in tolerances."""
    steps = [np.abs(np.subtract(leg.end, leg.start) / TOLERANCES).max() / (count - 1) for leg in walked]
    return float(max(steps)) / 2.0


@settings(max_examples=400)
@given(st.one_of(legs, still), st.lists(st.one_of(legs, still), min_size=1, max_size=6))
@example(Leg((0, 0, 0, 0), (2, 0, 0, 0)), [Leg((0, 0, 0, 0), (0, 0, 0, 0)), Leg((2, 0, 0, 0), (2, 0, 0, 0))])
def test_coverage_agrees_with_dense_sampling(leg: Leg, walked: list[Leg]) -> None:
    worst = miss(leg, walked)
    if Tubes(AXES, walked).covers(leg):
        # Samples of what was walked lie apart: by so much they may miss what lies between them.
        assert worst <= 1.0 + spacing(walked)
    else:
        # One pose at least lies outside, and sampled poses are so near to it.
        assert worst >= 1.0 - spacing([leg]) - 1e-6


@settings(max_examples=200)
@given(legs, st.floats(-0.99, 0.99), st.floats(-0.99, 0.99), st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_part_shifted_within_the_tolerances_is_covered(
    walked: Leg, by_first: float, by_last: float, begin: float, end: float
) -> None:
    first, last = (np.array(each) for each in (walked.start, walked.end))
    start = first + begin * (last - first) + by_first * TOLERANCES
    stop = first + end * (last - first) + by_last * TOLERANCES
    assert Tubes(AXES, [walked]).covers(Leg(joints(start), joints(stop)))


@settings(max_examples=200)
@given(legs, st.integers(0, 3), st.sampled_from([-1.0, 1.0]))
def test_a_motion_beyond_a_tolerance_is_not_covered(walked: Leg, axis: int, way: float) -> None:
    values = np.array([walked.start, walked.end])
    beyond = (values[:, axis].max() if way > 0 else values[:, axis].min()) + way * 1.001 * TOLERANCES[axis]
    moved = values.copy()
    moved[:, axis] = beyond
    assert not Tubes(AXES, [walked]).covers(Leg(joints(moved[0]), joints(moved[1])))


@settings(max_examples=200)
@given(st.lists(places, min_size=2, max_size=4), st.lists(legs, min_size=1, max_size=4), st.randoms())
def test_what_is_covered_holds_for_corners_cut_anywhere(
    way: list[Pose], others: list[Leg], chance: Random
) -> None:
    start, *targets = way
    moved = [
        tuple(q + chance.uniform(-0.9, 0.9) * t for q, t in zip(p, TOLERANCES, strict=True)) for p in way
    ]
    walked = [Leg(joints(np.array(a)), joints(np.array(b))) for a, b in pairwise(moved)] + others
    if not all(Tubes(AXES, walked).covers(leg) for leg in legs_through(start, targets, blended=True)):
        return
    for one, two, three in zip(way, way[1:], way[2:], strict=False):
        shares = np.random.default_rng(1).dirichlet((0.5, 0.5, 0.5), 100)
        passed = shares @ np.array([one, two, three]) / TOLERANCES
        there = np.vstack([poses(each, 81) for each in walked]) / TOLERANCES
        worst = np.abs(passed[:, None, :] - there[None, :, :]).max(axis=2).min(axis=1).max()
        assert worst <= 1.0 + spacing(walked)


CORNER: list[Pose] = [(0.0, 0.0, 0.0, 0.0), (4.0, 0.0, 0.0, 0.0), (8.0, 1.0, 0.0, 0.0)]
WALKED = [
    Leg((0.0, -0.7, 0.0, 0.0), (4.0, -0.7, 0.0, 0.0)),
    Leg((4.0, -0.7, 0.0, 0.0), (8.0, 0.3, 0.0, 0.0)),
]


def test_a_corner_that_is_cut_takes_room_in_the_tube() -> None:
    stops, cuts = (legs_through(CORNER[0], CORNER[1:], blended=blended) for blended in (False, True))
    tubes = Tubes(AXES, WALKED)
    assert all(tubes.covers(leg) for leg in stops)
    # The corner bends by 1° in J2, so that the arm may pass half of that inside it: 0.7° + 0.5° are too much.
    assert [leg.cut for leg in cuts] == [(0.0, 0.5, 0.0, 0.0)] * 2
    assert not any(tubes.covers(leg) for leg in cuts)
    assert all(Tubes(AXES, stops).covers(leg) for leg in cuts)


def test_the_last_target_of_a_way_is_not_passed() -> None:
    (alone,) = legs_through(CORNER[0], CORNER[1:2], blended=True)
    assert alone.cut == ()


def test_ends_inside_do_not_cover_the_middle() -> None:
    away = Leg((0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)), Leg((9.0, 0.0, 0.0, 0.0), (9.0, 0.0, 0.0, 0.0))
    assert not Tubes(AXES, away).covers(Leg((0.0, 0.0, 0.0, 0.0), (9.0, 0.0, 0.0, 0.0)))


def test_two_tubes_together_cover_what_neither_does() -> None:
    one, two = (
        Leg((0.0, 0.0, 0.0, 0.0), (5.0, 0.0, 0.0, 0.0)),
        Leg((5.0, 0.5, 0.0, 0.0), (9.0, 0.5, 0.0, 0.0)),
    )
    across = Leg((0.0, 0.2, 1.0, 0.0), (9.0, 0.2, 1.0, 0.0))
    assert Tubes(AXES, [one, two]).covers(across)
    assert not Tubes(AXES, [one]).covers(across)
    assert not Tubes(AXES, [two]).covers(across)


def test_a_corner_is_not_cut_beyond_the_tube() -> None:
    corner = [
        Leg((0.0, 0.0, 0.0, 0.0), (20.0, 0.0, 0.0, 0.0)),
        Leg((20.0, 0.0, 0.0, 0.0), (20.0, 20.0, 0.0, 0.0)),
    ]
    assert not Tubes(AXES, corner).covers(Leg((0.0, 0.0, 0.0, 0.0), (20.0, 20.0, 0.0, 0.0)))
    assert Tubes(AXES, corner).covers(Leg((19.5, 0.0, 0.0, 0.0), (20.0, 0.5, 0.0, 0.0)))


def test_nothing_walked_covers_nothing() -> None:
    assert not Tubes(AXES).covers(Leg((0.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 0.0)))


def test_what_is_no_number_is_never_covered() -> None:
    walked = Tubes(AXES, [Leg((0.0, 0.0, 0.0, 0.0), (9.0, 0.0, 0.0, 0.0))])
    assert not walked.covers(Leg((0.0, 0.0, 0.0, 0.0), (float("nan"), 0.0, 0.0, 0.0)))
    assert not walked.covers(Leg((0.0, 0.0, 0.0, 0.0), (float("inf"), 0.0, 0.0, 0.0)))


def test_many_walked_motions_are_all_looked_at() -> None:
    walked = [Leg((10.0 * n, 0.0, 0.0, 0.0), (10.0 * n + 5.0, 0.0, 0.0, 0.0)) for n in range(200)]
    tubes = Tubes(AXES, walked)
    assert len(tubes) == 200
    assert all(tubes.covers(leg) for leg in walked)
    assert not tubes.covers(Leg((1993.0, 0.0, 0.0, 0.0), (1999.0, 0.0, 0.0, 0.0)))


def joints(values: NDArray[np.float64]) -> Pose:
    one, two, three, four = (float(value) for value in values)
    return one, two, three, four
