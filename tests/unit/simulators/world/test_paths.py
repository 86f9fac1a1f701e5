"""Ways through knots, blended ways and streams of glides against hand calculation and small steps."""

import itertools
import math
from collections.abc import Iterable
from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from catseye.simulators.config import ArmDynamics, EmulationConfig, ErrorBudget, Joints
from catseye.simulators.errors import BenchError
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.motion import blend, plan_way
from catseye.simulators.world.scara.arm import scara_bench
from catseye.simulators.world.scara.truth import draw_truth
from catseye.simulators.world.types import Floats
from tests.unit.simulators.benches import (
    P1,
    P2,
    P3,
    QUIET,
    aimed,
    axis_mm,
    constant_map,
    go,
    perfect_arm,
    quiet_bench,
)

HOME: Joints = (0.0, 0.0, 0.0, 0.0)
DYNAMICS = ArmDynamics(max_speed=(100.0, 200.0, 50.0, 400.0), max_acceleration=(500.0, 1000.0, 100.0, 2000.0))
CYCLE_S = 0.0071


def stream(bench: Bench, targets: Iterable[Joints]) -> None:
    """Have a bench glide from one target to the next, a cycle each."""
    for k, target in enumerate(targets):
        bench.call_at(bench.time_s + k * CYCLE_S, partial(bench.glide, target, CYCLE_S))


def test_consecutive_glides_join_at_constant_speeds() -> None:
    bench = quiet_bench()
    bench.glide((0.1, 0.0, 0.0, -0.1), 0.01)
    bench.advance(0.0025)
    assert bench.joints == pytest.approx((0.025, 0.0, 0.0, -0.025))
    bench.advance_to(0.01)
    bench.glide((0.3, 0.0, 0.0, -0.1), 0.01)
    assert bench.moving
    bench.advance_to(0.015)
    assert bench.joints == pytest.approx((0.2, 0.0, 0.0, -0.1))


def test_an_early_glide_leaves_the_one_before_where_it_is() -> None:
    bench = quiet_bench()
    bench.glide((0.1, 0.0, 0.0, 0.0), 0.01)
    bench.advance_to(0.005)
    bench.glide((0.0, 0.0, 0.0, 0.0), 0.01)
    assert bench.joints[0] == pytest.approx(0.05)
    bench.advance_to(0.010)
    assert bench.joints[0] == pytest.approx(0.025)


def test_glides_do_not_interfere_with_other_motions() -> None:
    bench = quiet_bench()
    bench.move_to((20.0, 0.0, 0.0, 0.0))
    with pytest.raises(BenchError, match="moves already"):
        bench.glide(HOME, CYCLE_S)
    bench.advance_to(bench.standstill_s)
    bench.glide((20.1, 0.0, 0.0, 0.0), CYCLE_S)
    with pytest.raises(BenchError, match="moves already"):
        bench.move_to(HOME)
    with pytest.raises(BenchError, match="moves already"):
        bench.follow(np.array([1.0]), np.array([HOME]))


def test_a_stream_is_logged_once_and_arrives_once() -> None:
    said: list[str] = []
    bench = scara_bench(perfect_arm(), QUIET, said.append)
    stream(bench, ((0.1 * k, 0.0, 0.0, 0.0) for k in range(1, 51)))
    bench.advance(1.0)
    assert [text.split()[0] for text in said] == ["stream", "arrival"]
    assert bench.joints[0] == pytest.approx(5.0)


def test_a_way_is_straight_and_even_from_knot_to_knot() -> None:
    bench = quiet_bench()
    bench.follow(np.array([0.1, 0.4]), np.array([[1.0, 2.0, 3.0, 4.0], [-2.0, 2.0, 6.0, 4.0]]))
    places = []
    for time_s in (0.05, 0.1, 0.2, 0.5):
        bench.advance_to(time_s)
        places.append(bench.joints)
    assert places[0] == pytest.approx((0.5, 1.0, 1.5, 2.0))
    assert places[1] == pytest.approx((1.0, 2.0, 3.0, 4.0))
    assert places[2] == pytest.approx((0.0, 2.0, 4.0, 4.0))
    assert places[3] == (-2.0, 2.0, 6.0, 4.0)


@pytest.mark.parametrize("times", [[], [0.0, 1.0], [0.5, 0.5], [0.5, 0.2]])
def test_a_way_without_increasing_times_is_refused(times: list[float]) -> None:
    with pytest.raises(BenchError, match="increase"):
        quiet_bench().follow(np.array(times), np.zeros((len(times), 4)))


def test_a_stop_brakes_along_the_way_round_its_corner() -> None:
    bench = quiet_bench()
    # 200 deg/s on both legs; J1's 2000 deg/s² need 0.1 s and 10 deg, 5 of them after the corner.
    bench.follow(np.array([0.1, 0.5]), np.array([[20.0, 0.0, 0.0, 0.0], [20.0, 80.0, 0.0, 0.0]]))
    bench.advance_to(0.075)
    assert bench.joints[0] == pytest.approx(15.0)
    bench.stop()
    assert bench.standstill_s == pytest.approx(0.175)
    bench.advance(1.0)
    assert bench.joints == pytest.approx((20.0, 5.0, 0.0, 0.0))


def test_a_stopped_glide_goes_straight_on_while_it_brakes() -> None:
    bench = quiet_bench()
    bench.glide((0.2, 0.0, 0.0, 0.0), 0.01)
    bench.advance_to(0.005)
    bench.stop()
    bench.advance(1.0)
    # 20 deg/s at 2000 deg/s²: 0.01 s and 0.1 deg, from 0.1 deg on.
    assert bench.joints[0] == pytest.approx(0.2)
    bench.glide((0.3, 0.0, 0.0, 0.0), 0.01)
    bench.advance_to(bench.time_s + 0.009)
    bench.stop()
    bench.advance(1.0)
    # 10 deg/s: 0.025 deg, from 0.29 deg on.
    assert bench.joints[0] == pytest.approx(0.315)


def small_steps_play(knots_deg: list[float], travel_deg: float) -> float:
    """Integrate the play operator along straight legs in small steps, the textbook way."""
    play, here, count = -1.0, 0.0, 500
    for knot in knots_deg:
        for _ in range(count):
            play = min(1.0, max(-1.0, play + 2.0 * (knot - here) / count / travel_deg))
        here = knot
    return play


def played_bench() -> Bench:
    truth = replace(perfect_arm(), theta1_map=constant_map(-3.0, 3.0), theta2_map=constant_map(-2.0, 4.0))
    return quiet_bench(truth=truth)


knot_lists = st.lists(st.floats(-0.1, 0.1), min_size=1, max_size=12)


@given(knots_deg=knot_lists, done=st.floats(0.0, 1.2))
def test_play_on_a_way_with_reversals_equals_small_steps(knots_deg: list[float], done: float) -> None:
    bench = played_bench()
    times = np.linspace(0.1, 0.1 * len(knots_deg), len(knots_deg))
    bench.follow(times, np.array([[angle, -angle, 0.0, 0.0] for angle in knots_deg]))
    bench.advance_to(done * float(times[-1]))
    passed = [angle for angle, time in zip(knots_deg, times, strict=True) if time < bench.time_s]
    passed.append(bench.joints[0])
    play1, play2, _ = bench.true_state().play
    assert play1 == pytest.approx(small_steps_play(passed, 0.05), abs=1e-6)
    assert play2 == pytest.approx(small_steps_play([-angle for angle in passed], 0.05), abs=1e-6)


@given(knots_deg=knot_lists)
def test_play_in_a_stream_with_reversals_equals_small_steps(knots_deg: list[float]) -> None:
    bench = played_bench()
    for angle in knots_deg:
        bench.glide((angle, 0.0, 0.0, 0.0), CYCLE_S)
        bench.advance(CYCLE_S)
    assert bench.true_state().play[0] == pytest.approx(small_steps_play(knots_deg, 0.05), abs=1e-6)


def test_a_beam_that_misses_on_the_way_only_is_lost() -> None:
    bench = quiet_bench()
    go(bench, aimed(20.0, 30.0))
    j1, j2, j3, j4 = bench.joints
    assert bench.beam.zero()
    # 0.3 deg beside the aim at 280 mm are 1.5 mm, for a few milliseconds.
    bench.follow(np.array([0.1, 0.2]), np.array([[j1, j2, j3, j4 + 0.3], [j1, j2, j3, j4]]))
    bench.advance(1.0)
    assert bench.beam.read().returns
    assert bench.beam.read().beam_lost


def test_an_aimed_way_and_an_aimed_stream_keep_the_count() -> None:
    for streamed in (False, True):
        bench = quiet_bench()
        go(bench, aimed(20.0, 30.0))
        assert bench.beam.zero()
        start_mm = bench.true_state().length_mm
        knots = [aimed(20.0 + 0.1 * k, 30.0) for k in range(1, 101)]
        if streamed:
            stream(bench, knots)
        else:
            bench.follow(np.linspace(0.01, 1.0, 100), np.array(knots))
        bench.advance(2.0)
        reading = bench.beam.read()
        assert not reading.beam_lost
        way_mm = abs(680.0 - axis_mm(30.0, 30.0)) - start_mm
        assert reading.displacement_mm == pytest.approx(way_mm, abs=1e-6)


def test_a_stream_scatters_once() -> None:
    bench = quiet_bench(replace(QUIET, budget=replace(ErrorBudget.none(), repeatability_um=10.0)))
    errors = []
    for k in range(1, 40):
        bench.glide((0.1 * k, 0.0, 0.0, 0.0), CYCLE_S)
        bench.advance(CYCLE_S)
        errors.append(complex(*bench.true_state().axis_mm) - axis_mm(0.1 * k, 0.0))
    assert errors == pytest.approx([errors[0]] * len(errors), abs=1e-9)
    assert abs(errors[0]) > 1e-4
    bench.advance(1.0)
    bench.glide((0.0, 0.0, 0.0, 0.0), CYCLE_S)
    bench.advance(CYCLE_S)
    assert abs(complex(*bench.true_state().axis_mm) - 550.0 - errors[0]) > 1e-4


def test_a_stream_rings_at_its_end_only() -> None:
    bench = quiet_bench(replace(QUIET, budget=replace(ErrorBudget.none(), vibration_um=20.0)))
    for k in range(1, 40):
        bench.glide((0.1 * k, 0.0, 0.0, 0.0), CYCLE_S)
        bench.advance(CYCLE_S)
        assert abs(complex(*bench.true_state().axis_mm) - axis_mm(0.1 * k, 0.0)) < 1e-9
    bench.advance(0.0162)
    swing_um = 1e3 * abs(complex(*bench.true_state().axis_mm) - axis_mm(3.9, 0.0))
    # The first crest of 15 Hz with a decay of 80 ms.
    assert swing_um == pytest.approx(20.0 * math.exp(-0.0162 / 0.08), rel=0.02)


def test_two_moves_blend_where_the_first_begins_to_brake() -> None:
    times, joints = blend([HOME, (50.0, 0.0, 0.0, 0.0), (50.0, 100.0, 0.0, 0.0)], DYNAMICS)
    # Each move takes 0.7 s with ramps of 0.2 s, 10 deg and 20 deg: the second begins after 0.5 s at 40 deg.
    way = plan_way(HOME, times, joints, 0.0)
    assert way.end_s == pytest.approx(1.2)
    assert way.end == pytest.approx((50.0, 100.0, 0.0, 0.0))
    assert way.joints_at(0.5) == pytest.approx((40.0, 0.0, 0.0, 0.0), abs=1e-9)
    assert way.joints_at(0.6) == pytest.approx((47.5, 5.0, 0.0, 0.0), abs=1e-9)
    assert way.joints_at(0.7) == pytest.approx((50.0, 20.0, 0.0, 0.0), abs=1e-9)


def test_via_points_on_a_line_are_passed_at_full_speed() -> None:
    times, joints = blend([HOME, (50.0, 0.0, 0.0, 0.0), (100.0, 0.0, 0.0, 0.0)], DYNAMICS)
    way = plan_way(HOME, times, joints, 0.0)
    assert way.end_s == pytest.approx(1.2)
    assert way.joints_at(0.65)[0] - way.joints_at(0.55)[0] == pytest.approx(10.0, rel=1e-3)


def test_no_way_is_empty() -> None:
    times, joints = blend([HOME, HOME, HOME], DYNAMICS)
    assert times.size == 0
    assert joints.shape == (0, 4)


points = st.tuples(*[st.floats(-60.0, 60.0)] * 4).map(lambda p: (p[0], p[1], abs(p[2]), p[3]))


@given(via=st.lists(points, min_size=1, max_size=6))
def test_a_blended_path_reaches_its_end_within_speed_limits(via: list[Joints]) -> None:
    times, joints = blend([HOME, *via], DYNAMICS)
    assume(times.size > 0)
    assert joints[-1] == pytest.approx(via[-1], abs=1e-9)
    assert np.all(np.diff(times, prepend=0.0) > 0.0)
    speeds = np.diff(joints, axis=0, prepend=[HOME]) / np.diff(times, prepend=0.0)[:, None]
    # Two ramps of different lengths may add up to a little more than one of the two speeds, never to both.
    assert np.all(np.abs(speeds) <= 1.5 * np.array(DYNAMICS.max_speed))


Script = list[tuple[str, float, float]]
acts = st.tuples(
    st.sampled_from(["stream", "way", "stop", "read"]), st.floats(-1.0, 1.0), st.floats(0.0, 0.3)
)


def play_script(script: Script, cuts: int) -> list[object]:
    """Carry out commands at fixed bench times, each wait cut into equal parts; return all that can be seen."""
    config = EmulationConfig(reflectors=(P1, P2, P3), seed=5, start_joints=aimed(20.0, 30.0))
    bench = scara_bench(draw_truth(5, config), config)
    seen: list[object] = []
    for what, size_deg, wait_s in script:
        start_s, until_s = bench.time_s, bench.time_s + wait_s
        if what == "stream" and not bench.moving:
            _begin_stream(bench, size_deg)
        elif what == "way" and not bench.moving:
            bench.follow(np.array([0.05, 0.1, 0.15, 0.2]), _zigzag(bench.joints, size_deg))
        elif what == "stop":
            bench.stop()
        reading = bench.beam.read()
        seen.append((round(reading.displacement_mm, 8), reading.beam_lost, reading.overspeed))
        for part in range(1, cuts):
            bench.advance_to(start_s + wait_s * part / cuts)
        bench.advance_to(until_s)
    insight = bench.true_state()
    return [*seen, *(round(value, 8) for value in (*insight.axis_mm, *insight.play, insight.length_mm))]


def _begin_stream(bench: Bench, size_deg: float) -> None:
    j1, j2, j3, j4 = bench.joints
    sways = [sway * size_deg for sway in (0.1, 0.3, 0.2, 0.2, -0.1)]
    for k, sway in enumerate(sways):
        bench.call_at(bench.time_s + k * CYCLE_S, partial(_glide, bench, (j1 + sway, j2, j3, j4 - sway)))


def _glide(bench: Bench, target: Joints) -> None:
    # After a stop the rest of the stream is in vain.
    try:
        bench.glide(target, CYCLE_S)
    except BenchError:
        return


def _zigzag(joints: Joints, size_deg: float) -> Floats:
    j1, j2, j3, j4 = joints
    signs = itertools.accumulate((1.0, -1.5, 0.7, 0.3))
    return np.array([(j1 + sign * size_deg, j2 - sign * size_deg, j3, j4) for sign in signs])


@settings(max_examples=60)
@given(script=st.lists(acts, min_size=1, max_size=8), cuts=st.integers(2, 40))
def test_results_do_not_depend_on_the_steps_of_time(script: Script, cuts: int) -> None:
    assert play_script(script, cuts) == play_script(script, 1)
