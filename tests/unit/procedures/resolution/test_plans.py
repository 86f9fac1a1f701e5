"""Plans of resolution tests against the resolution paper's own figures."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.procedures.kit.errors import PlanError, PlanLimitError
from catseye.procedures.resolution.backlash import Backlash, BacklashParams
from catseye.procedures.resolution.campaign_plan import Series
from catseye.procedures.resolution.cartesian import CartesianParams, ResolutionCartesian
from catseye.procedures.resolution.iso import IsoParams, ResolutionIso
from catseye.procedures.resolution.places import places_of
from catseye.procedures.resolution.resolution import Resolution, ResolutionParams, ended_early
from catseye.procedures.resolution.step_sizes import decaying, there_and_back
from tests.unit.procedures.resolution.benches import SIX, kuka

TABLE_2 = {
    "A1": (-175, -90, 0, 90, 175),
    "A2": (-130, -100, -70, -40, -15),
    "A3": (-110, -25, 60, 90, 145),
    "A4": (-180, -90, 0, 90, 180),
    "A5": (-110, -55, 0, 55, 110),
    "A6": (-180, -90, 0, 90, 180),
}
"""Tested joint angular positions, typed from the paper."""

POSE = (0.0, -20.0, 20.0, 0.0, 40.0, 0.0)


def commands(series: Series) -> list[float]:
    return [order.command for order in series.orders]


def test_steps_decay_as_the_paper_has_them() -> None:
    sizes = decaying(0.1, 109, None)
    assert len(sizes) == 109
    assert sizes[0] == 0.1
    assert sizes[1] == pytest.approx(0.0932603, abs=1e-7)
    # "Down to about 5e-5 deg."
    assert sizes[-1] == pytest.approx(5.3e-5, abs=0.05e-5)


def test_a_pose_of_another_arm_is_named() -> None:
    poses = [list(POSE), [0.0, -20.0]]
    with pytest.raises(PlanError, match="poses_deg, P2: 2 values where the arm has 6 axes"):
        ResolutionCartesian().plan(SIX, CartesianParams(poses_deg=poses))


def test_a_singular_pose_is_refused_before_its_wrist_whirls() -> None:
    stretched = [*POSE[:4], 0.0, 0.0]
    with pytest.raises(PlanError, match=r"along Y.*A[46] by .*° .*choose another pose"):
        ResolutionCartesian().plan(SIX, CartesianParams(poses_deg=[stretched]))


def test_a_series_ends_at_what_the_controller_can_command() -> None:
    sizes = decaying(0.1, 109, 0.001)
    assert sizes[0] == pytest.approx(0.1)
    assert sizes[-1] == pytest.approx(0.001)


@given(resolution=st.sampled_from([0.001, 0.01]), first=st.floats(0.02, 1.0))
def test_steps_are_distinct_multiples_of_what_is_commanded(resolution: float, first: float) -> None:
    multiples = np.array(decaying(first, 400, resolution)) / resolution
    assert multiples == pytest.approx(np.round(multiples), abs=1e-6)
    assert np.diff(multiples).max(initial=-1.0) <= -1.0 + 1e-6
    # Each lies as near to the series as a multiple can.
    series = first / 1.072267 ** np.arange(400.0) / resolution
    assert np.abs(series[:, None] - multiples).min(axis=0).max() <= 0.5 + 1e-6


def test_rounded_steps_are_as_many_as_were_asked() -> None:
    assert len(decaying(0.1, 30, 0.001)) == 30


@given(
    size=st.floats(1e-5, 0.5),
    senses=st.lists(st.sampled_from([1, -1]), min_size=1, max_size=10),
    steps=st.integers(1, 20),
)
def test_sequences_go_there_and_back(size: float, senses: list[int], steps: int) -> None:
    moves = there_and_back(size, tuple(senses), steps)
    assert len(moves) == len(senses) * steps
    assert math.fsum(by for _, by in moves) == pytest.approx(size * steps * sum(senses))
    assert [number for number, _ in moves] == sorted(number for number, _ in moves)


def test_a_kuka_is_tested_where_the_paper_tested_it() -> None:
    bench = kuka()
    assert {axis: places_of(bench, axis) for axis in TABLE_2} == TABLE_2


def test_an_arm_without_places_is_tested_over_its_range() -> None:
    assert places_of(SIX, "A1") == pytest.approx((-155.0, -77.5, 0.0, 77.5, 155.0))


def test_the_whole_campaign_is_thirty_places_and_sixty_series() -> None:
    plan = Resolution().plan(kuka(), ResolutionParams())
    assert [(place.joint, place.name) for place in plan.places] == [
        (axis, f"K{number}") for axis in TABLE_2 for number in range(1, 6)
    ]
    assert sum(len(place.series) for place in plan.places) == 60
    # The paper: one series takes less than 15 min; 60 recordings are 11 h of bench time.
    for place in plan.places:
        assert all(60.0 + 109 * 5.0 < plan.series_s(series) < 900.0 for series in place.series)
    assert plan.duration_s / 3600.0 == pytest.approx(11.0, abs=0.6)


def test_each_direction_is_run_in_and_stepped_one_way() -> None:
    (place,) = Resolution().plan(SIX, ResolutionParams(joints=["A2"], positions=["K3"])).places
    up, down = place.series
    assert [pose[1] for pose in up.run_in] == pytest.approx([-5.0, 0.0])
    assert [pose[1] for pose in down.run_in] == pytest.approx([5.0, 0.0])
    assert commands(up) == pytest.approx([0.1 / 1.072267**n for n in range(109)])
    assert commands(down) == [-size for size in commands(up)]
    assert {order.target for order in (*up.orders, *down.orders)} == {None}
    assert (up.step_id, down.step_id) == ("A2/K3/+", "A2/K3/-")


def test_the_range_is_checked_to_either_side() -> None:
    (place,) = Resolution().plan(SIX, ResolutionParams(joints=["A2"], positions=["K3"])).places
    values = [pose[1] for pose in place.range_check]
    assert (max(values), min(values), values[-1]) == (5.0, -5.0, 0.0)
    assert np.abs(np.diff([0.0, *values])).max() == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("changes", "up", "down"),
    [
        # 1° (1 - 1 / 1.072267^109) / (1 - 1 / 1.072267) = 14.83°.
        ({"first_deg": 1.0}, 14.83, 14.83),
        ({"first_deg": 1.0, "directions": [1]}, 14.83, 5.0),
        ({"run_in_deg": 10.0, "directions": [1]}, 5.0, 10.0),
        ({"run_in_deg": 0.5}, 5.0, 5.0),
    ],
)
def test_the_beam_is_checked_wherever_the_test_leads(changes: dict[str, Any], up: float, down: float) -> None:
    params = ResolutionParams.model_validate({"joints": ["A2"], "positions": ["K3"], **changes})
    (place,) = Resolution().plan(SIX, params).places
    values = [pose[1] for pose in place.range_check]
    assert (max(values), min(values), values[-1]) == pytest.approx((up, -down, 0.0), abs=0.01)
    assert np.abs(np.diff([0.0, *values])).max() <= 1.0 + 1e-9


@pytest.mark.parametrize(
    ("changes", "up", "down"),
    [
        # 1 mm (1 - 1 / 1.072267^100) / (1 - 1 / 1.072267) = 14.82 mm.
        ({}, 14.82, 14.82),
        ({"directions": ["-Z"], "run_in_mm": 8.0}, 8.0, 14.82),
        ({"steps": 5, "first_mm": 0.1, "run_in_mm": 1.0}, 5.0, 5.0),
    ],
)
def test_straight_travel_is_checked_to_its_end(changes: dict[str, Any], up: float, down: float) -> None:
    params = CartesianParams.model_validate({"poses_deg": [list(POSE)], **changes})
    place = ResolutionCartesian().plan(SIX, params).places[-1]
    frames = SIX.workspace.chain.frames(np.array([place.pose, *place.range_check]))
    heights = frames[-1, :, 2, 3] - frames[-1, 0, 2, 3]
    assert heights == pytest.approx([0.0, up, -down, 0.0], abs=0.01)


def test_the_iso_test_has_three_sequences_of_ten_poses() -> None:
    params = IsoParams(joints=["A1"], positions=["K3"], amplitudes_deg=[0.01, 0.002])
    (place,) = ResolutionIso().plan(SIX, params).places
    small, large = place.series
    assert (small.amplitude, large.amplitude) == (0.002, 0.01)
    assert commands(large) == [0.01] * 10 + [-0.01] * 10 + [0.01] * 10
    ends = [order.target[0] for order in large.orders if order.target is not None]
    up, down = np.arange(1, 11) * 0.01, np.arange(9, -1, -1) * 0.01
    assert ends == pytest.approx([*up, *down, *up])


def test_the_iso_test_can_be_relative() -> None:
    params = IsoParams(joints=["A1"], positions=["K3"], amplitudes_deg=[0.01], relative=True)
    (place,) = ResolutionIso().plan(SIX, params).places
    assert {order.target for order in place.series[0].orders} == {None}


def test_backlash_is_centred_and_goes_there_and_back_five_times() -> None:
    (place,) = Backlash().plan(SIX, BacklashParams(joints=["A1"], positions=["K3"])).places
    (series,) = place.series
    assert [order.sequence for order in series.orders] == [0] * 5 + [
        n for n in range(1, 6) for _ in range(20)
    ]
    ends = [order.target[0] for order in series.orders if order.target is not None]
    assert max(ends) == pytest.approx(0.5)
    assert min(ends) == pytest.approx(-0.5)
    # Each of the eleven places but the outermost is met from both sides in every cycle.
    assert ends[4] == pytest.approx(-0.5)
    assert ends[5:25] == pytest.approx([*np.arange(-0.4, 0.51, 0.1), *np.arange(0.4, -0.51, -0.1)], abs=1e-12)


def test_straight_steps_go_in_six_directions() -> None:
    plan = ResolutionCartesian().plan(SIX, CartesianParams(poses_deg=[list(POSE)]))
    assert [place.joint for place in plan.places] == ["X", "Y", "Z"]
    titles = [series.title for place in plan.places for series in place.series]
    assert titles == ["+X at P1", "-X at P1", "+Y at P1", "-Y at P1", "+Z at P1", "-Z at P1"]
    chain = SIX.workspace.chain
    series = plan.places[2].series[1]
    assert series.along == (0.0, 0.0, 1.0)
    assert commands(series)[0] == -1.0
    before, at = chain.frames(np.array(series.run_in))[-1, :, :3, 3]
    assert at - before == pytest.approx([0.0, 0.0, -5.0], abs=1e-6)


def test_a_driver_without_straight_steps_is_refused() -> None:
    bench = replace(SIX, arm=replace(SIX.arm, steps=False))
    with pytest.raises(PlanError, match="takes no straight steps"):
        ResolutionCartesian().plan(bench, CartesianParams(poses_deg=[list(POSE)]))


def test_a_place_beyond_the_limits_is_named() -> None:
    axes = tuple(replace(axis, high=150.0) if axis.name == "A1" else axis for axis in SIX.arm.axes)
    places = ((0.0, 148.0), *[()] * 5)
    bench = replace(SIX, arm=replace(SIX.arm, axes=axes, test_places=places))
    with pytest.raises(PlanLimitError, match=r"A1 at K2: .*leave this position out"):
        Resolution().plan(bench, ResolutionParams(joints=["A1"]))


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"joints": ["A7"]}, "A7 is not an axis that turns"),
        ({"joints": ["A1"], "positions": ["K6"]}, "there is no position K6"),
        ({"joints": ["A1"], "pose_deg": [1.0, 2.0]}, "pose_deg: 2 values where the arm has 6 axes"),
    ],
)
def test_unknown_names_are_refused(changes: dict[str, list[str]], said: str) -> None:
    with pytest.raises(PlanError, match=said):
        Resolution().plan(SIX, ResolutionParams.model_validate(changes))


def test_a_series_that_the_controller_ends_says_why() -> None:
    bench = replace(SIX, arm=replace(SIX.arm, command_resolution={"deg": 0.001}))
    plan = Resolution().plan(bench, ResolutionParams(joints=["A1"], positions=["K3"]))
    # Down to 0.014° the paper's 29 sizes stay apart when they are rounded to 0.001°; 13 multiples are left.
    assert len(plan.places[0].series[0].orders) == 42
    assert "the series end at 0.001°" in ended_early(plan)


def test_a_series_of_all_its_steps_says_nothing() -> None:
    assert not ended_early(Resolution().plan(SIX, ResolutionParams(joints=["A1"], positions=["K3"])))
    bench = replace(SIX, arm=replace(SIX.arm, command_resolution={"deg": 0.001}))
    assert not ended_early(
        Resolution().plan(bench, ResolutionParams(joints=["A1"], positions=["K3"], steps=20))
    )


def test_a_controller_that_resolves_nothing_of_a_series_is_refused() -> None:
    bench = replace(SIX, arm=replace(SIX.arm, command_resolution={"deg": 0.2}))
    with pytest.raises(PlanError, match="no step that this controller can command"):
        Resolution().plan(bench, ResolutionParams(joints=["A1"]))
