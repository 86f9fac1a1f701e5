"""Beam and counter: hits, breaks, latches, and independence of the steps of time."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.calibration.air import refractive_index
from catseye.simulators.config import AirState, EmulationConfig, ErrorBudget, Joints
from catseye.simulators.errors import BenchError
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.counter import Reading
from catseye.simulators.world.scara.arm import scara_bench
from catseye.simulators.world.scara.truth import draw_truth
from tests.unit.simulators.benches import (
    P1,
    P2,
    P3,
    QUIET,
    aimed,
    axis_mm,
    go,
    perfect_arm,
    quiet_bench,
    without_j4_play,
)


def on_target(config: EmulationConfig = QUIET) -> Bench:
    """Return a bench that stands at (20, 30) deg, aimed at P2 and zeroed."""
    bench = quiet_bench(config)
    go(bench, aimed(20.0, 30.0))
    assert bench.beam.zero()
    return bench


def follow(bench: Bench, target: tuple[float, float], steps: int) -> None:
    """Go from the present joints to others in steps, the beam aimed at P2 at each."""
    start = bench.joints
    for k in range(1, steps + 1):
        part = k / steps
        j1, j2 = (start[n] + part * (target[n] - start[n]) for n in (0, 1))
        go(bench, aimed(j1, j2))


def test_an_aimed_beam_returns_with_the_true_length() -> None:
    bench = quiet_bench()
    go(bench, aimed(20.0, 30.0))
    insight = bench.true_state()
    assert insight.reflector == "P2"
    assert insight.miss_mm == pytest.approx(0.0, abs=1e-9)
    assert insight.length_mm == pytest.approx(abs(680.0 - axis_mm(20.0, 30.0)))


def test_the_beam_returns_up_to_the_accepted_miss() -> None:
    bench = quiet_bench()
    j1, j2, j3, j4 = aimed(20.0, 30.0)
    length = abs(680.0 - axis_mm(20.0, 30.0))
    for miss_mm, returns in ((0.5, True), (0.99, True), (1.01, False)):
        go(bench, (j1, j2, j3, j4 + math.degrees(math.asin(miss_mm / length))))
        insight = bench.true_state()
        assert insight.miss_mm == pytest.approx(miss_mm, abs=1e-6)
        assert (insight.reflector is not None) is returns
        assert insight.length_mm == pytest.approx(math.sqrt(length**2 - miss_mm**2))


def test_the_signal_falls_with_the_miss() -> None:
    bench = quiet_bench()
    j1, j2, j3, j4 = aimed(20.0, 30.0)
    length = abs(680.0 - axis_mm(20.0, 30.0))
    levels = []
    for miss_mm in (0.0, 0.5, 0.9, 1.1):
        go(bench, (j1, j2, j3, j4 + math.degrees(math.asin(miss_mm / length))))
        levels.append(bench.beam.read().level)
    expected = [1.0, math.exp(-0.5), math.exp(-2.0 * 0.81), 0.0]
    assert levels == pytest.approx(expected, abs=0.02)


def test_the_beam_offset_is_the_slope_of_the_length() -> None:
    bench = quiet_bench(replace(QUIET, beam_offset_mm=0.2))
    j1, j2, j3, j4 = aimed(20.0, 30.0)
    go(bench, (j1, j2, j3, j4))
    assert bench.true_state().miss_mm == pytest.approx(0.2)
    lengths = []
    # With the offset to the left the beam meets the centre when it is turned to the right.
    turn = math.asin(0.2 / abs(680.0 - axis_mm(20.0, 30.0)))
    for delta in (-1e-3, 1e-3):
        go(bench, (j1, j2, j3, j4 - math.degrees(turn) + math.degrees(delta)))
        lengths.append(bench.true_state().length_mm)
    assert (lengths[1] - lengths[0]) / 2e-3 == pytest.approx(0.2, rel=1e-3)


def test_a_reflector_behind_the_beam_does_not_return_it() -> None:
    bench = quiet_bench()
    j1, j2, j3, j4 = aimed(20.0, 30.0)
    go(bench, (j1, j2, j3, j4 + 180.0))
    assert bench.true_state().reflector is None
    assert not bench.beam.read().returns


def test_the_column_hides_the_reflector() -> None:
    bench = quiet_bench()
    # From (-541, 95) mm the line to (680, 0) mm passes the J1 axis at 53 mm; from (-476, 275) mm at 157 mm.
    go(bench, aimed(170.0, 0.0))
    assert bench.true_state().miss_mm < 1e-6
    assert bench.true_state().reflector is None
    go(bench, aimed(150.0, 0.0))
    assert bench.true_state().reflector == "P2"


@pytest.mark.parametrize(
    ("facing_deg", "returns"), [(180.0, True), (101.0, True), (99.0, False), (0.0, False)]
)
def test_the_field_of_the_cats_eye_is_limited(facing_deg: float, *, returns: bool) -> None:
    place = replace(P2, facing_deg=facing_deg)
    bench = quiet_bench(replace(QUIET, reflectors=(place,)))
    # The straight arm along +X looks along +X; the beam leaves the reflector at 180 deg.
    go(bench, (0.0, 0.0, 0.0, 0.0))
    assert (bench.true_state().reflector is not None) is returns


def test_the_first_of_two_reflectors_in_line_is_hit() -> None:
    near = replace(P2, name="near", x_mm=600.0)
    bench = quiet_bench(replace(QUIET, reflectors=(P2, near)))
    assert bench.true_state().reflector == "near"


def test_a_lifted_beam_misses() -> None:
    bench = quiet_bench()
    go(bench, (0.0, 0.0, 0.9, 0.0))
    assert bench.true_state().miss_mm == pytest.approx(0.9)
    go(bench, (0.0, 0.0, 1.1, 0.0))
    assert bench.true_state().reflector is None


def test_one_straight_move_between_aimed_poses_breaks_the_beam() -> None:
    bench = on_target()
    go(bench, aimed(40.0, 50.0))
    reading = bench.beam.read()
    assert reading.returns
    assert reading.beam_lost


def test_a_path_in_small_steps_keeps_the_count() -> None:
    bench = on_target()
    start_mm = bench.true_state().length_mm
    follow(bench, (40.0, 50.0), 20)
    reading = bench.beam.read()
    assert not reading.beam_lost
    assert reading.displacement_mm == pytest.approx(bench.true_state().length_mm - start_mm, abs=1e-9)
    assert abs(reading.displacement_mm) > 10.0


def test_the_displacement_grows_with_the_beam() -> None:
    bench = on_target()
    before_mm = bench.true_state().length_mm
    follow(bench, (25.0, 35.0), 10)
    assert bench.true_state().length_mm > before_mm
    assert bench.beam.read().displacement_mm > 0.0


def test_the_vacuum_count_includes_index_and_dead_path_change() -> None:
    air = AirState(drift_k=2.0, drift_hpa=10.0, drift_percent=5.0)
    bench = on_target(replace(QUIET, air=air))

    def index() -> float:
        now = bench.air()
        return float(refractive_index(632.9908, now.temperature_c, now.pressure_hpa, now.humidity_percent))

    n_zero, dead_mm = index(), bench.true_state().length_mm
    bench.advance(1800.0)
    still = bench.beam.read()
    assert still.displacement_mm == pytest.approx(0.0, abs=1e-9)
    assert still.vacuum_mm == pytest.approx((index() - n_zero) * dead_mm, abs=2e-5)
    assert abs(still.vacuum_mm) > 1e-4
    follow(bench, (25.0, 35.0), 10)
    length_mm = bench.true_state().length_mm
    assert bench.beam.read().vacuum_mm == pytest.approx(index() * length_mm - n_zero * dead_mm, abs=2e-5)


def test_a_lost_count_stays_lost_and_wrong_until_zero() -> None:
    bench = on_target()
    true_mm = bench.true_state().length_mm
    go(bench, aimed(40.0, 50.0))
    go(bench, aimed(20.0, 30.0))
    reading = bench.beam.read()
    assert reading.returns
    assert reading.beam_lost
    assert abs(reading.displacement_mm) > 3e-4
    assert bench.true_state().length_mm == pytest.approx(true_mm)
    assert bench.beam.zero()
    again = bench.beam.read()
    assert not again.beam_lost
    assert again.displacement_mm == 0.0
    assert again.zero_id == reading.zero_id + 1


def test_without_a_beam_zero_is_refused_and_the_count_frozen() -> None:
    bench = on_target()
    follow(bench, (25.0, 35.0), 10)
    j1, j2, j3, j4 = bench.joints
    go(bench, (j1, j2, j3, j4 + 10.0))
    held = bench.beam.read()
    assert not held.returns
    assert not bench.beam.zero()
    bench.advance(5.0)
    after = bench.beam.read()
    assert after.displacement_mm == held.displacement_mm
    assert after.vacuum_mm == held.vacuum_mm
    assert after.beam_lost
    assert after.zero_id == 1


def test_a_break_shorter_than_a_step_of_time_is_seen() -> None:
    """The beam sweeps over P2 within one advance: it returns before and after, not in between."""
    bench = on_target()
    j1, j2, j3, j4 = bench.joints
    go(bench, (j1, j2, j3, j4 + 3.0), 100.0)
    bench.move_to((j1, j2, j3, j4), 100.0)
    bench.advance(10.0)
    assert bench.beam.read().returns
    assert bench.beam.read().beam_lost


def test_changing_the_reflector_is_a_break() -> None:
    far = replace(P2, name="far", x_mm=690.0, y_mm=1.5)
    bench = quiet_bench(replace(QUIET, reflectors=(P2, far), acceptance_mm=1.0))
    assert bench.beam.zero()
    assert bench.true_state().reflector == "P2"
    # 0.7 mm to the left of P2 is 0.8 mm to the right of the other one: no gap between the two.
    go(bench, (0.0, 0.0, 0.0, math.degrees(math.atan2(1.3, 140.0))), 1.0)
    reading = bench.beam.read()
    assert bench.true_state().reflector == "far"
    assert reading.returns
    assert reading.beam_lost


def test_a_blocked_beam_returns_after_its_time() -> None:
    bench = on_target()
    bench.beam.block(2.0)
    assert not bench.beam.read().returns
    bench.advance(1.9)
    assert not bench.beam.read().returns
    bench.advance(0.2)
    assert bench.beam.read().returns
    assert bench.beam.read().beam_lost


def test_a_beam_blocked_for_ever_is_freed_by_hand() -> None:
    bench = on_target()
    bench.beam.block(None)
    bench.advance(1e6)
    assert not bench.beam.read().returns
    bench.beam.unblock()
    assert bench.beam.read().returns


def test_a_moved_reflector_is_counted_and_not_forgiven() -> None:
    bench = on_target()
    way = complex(680.0, 0.0) - axis_mm(20.0, 30.0)
    step = 0.5 * way / abs(way)
    bench.beam.move_reflector("P2", step.real, step.imag)
    assert bench.beam.read().displacement_mm == pytest.approx(0.5)
    assert not bench.beam.read().beam_lost
    bench.beam.move_reflector("P2", 0.0, 300.0)
    assert bench.beam.read().beam_lost
    with pytest.raises(BenchError, match="P1, P2, P3"):
        bench.beam.move_reflector("P9", 1.0, 0.0)


def test_too_fast_a_move_latches_overspeed() -> None:
    place = replace(P2, x_mm=680.0)
    config = replace(QUIET, reflectors=(place,), acceptance_mm=500.0, speed_limit_mm_s=100.0)
    bench = quiet_bench(config)
    assert bench.beam.zero()
    go(bench, (0.0, 0.0, 0.0, 0.0))
    before_mm = bench.true_state().length_mm
    go(bench, (30.0, 0.0, 0.0, -30.0), 100.0)
    reading = bench.beam.read()
    assert reading.overspeed
    assert not reading.beam_lost
    assert abs(reading.displacement_mm - (bench.true_state().length_mm - before_mm)) > 1.0


def test_the_counter_measures_its_velocity() -> None:
    config = replace(QUIET, reflectors=(P2,), acceptance_mm=500.0)
    bench = quiet_bench(config)
    assert bench.velocity_mm_s() == 0.0
    bench.move_to((30.0, 0.0, 0.0, -30.0), 10.0)
    bench.advance(0.2)
    first_mm = bench.true_state().length_mm
    bench.advance(0.001)
    rate = (bench.true_state().length_mm - first_mm) / 0.001
    assert bench.velocity_mm_s() == pytest.approx(rate, rel=1e-6)


def test_scale_noise_drift_and_resolution_follow_the_budget() -> None:
    budget = replace(ErrorBudget.none(), counter_noise_um=0.1, counter_resolution_um=0.01)
    bench = on_target(replace(QUIET, budget=budget))
    values = np.array([bench.beam.read().displacement_mm for _ in range(2000)])
    assert np.std(values) == pytest.approx(1e-4, rel=0.1)
    assert values * 1e5 == pytest.approx(np.round(values * 1e5), abs=1e-6)


def test_the_scale_error_is_that_of_the_wavelength() -> None:
    budget = replace(ErrorBudget.none(), wavelength_um=40.0)
    bench = on_target(replace(QUIET, budget=budget))
    start_mm = bench.true_state().length_mm
    follow(bench, (40.0, 50.0), 20)
    way_mm = bench.true_state().length_mm - start_mm
    error_mm = bench.beam.read().displacement_mm - way_mm
    again = on_target(replace(QUIET, budget=budget))
    follow(again, (30.0, 40.0), 20)
    half_mm = again.true_state().length_mm - start_mm
    assert 0.0 < abs(error_mm) < 3.0 * 0.040 * abs(way_mm) / 700.0
    assert (again.beam.read().displacement_mm - half_mm) / half_mm == pytest.approx(error_mm / way_mm)


def test_white_noise_is_drawn_once_an_arrival() -> None:
    budget = replace(ErrorBudget.none(), white_um=15.0)
    bench = quiet_bench(replace(QUIET, budget=budget))
    draws = []
    for _ in range(300):
        go(bench, aimed(20.5, 30.5))
        go(bench, aimed(20.0, 30.0))
        values = {bench.beam.read().displacement_mm for _ in range(3)}
        assert len(values) == 1
        draws.append(bench.true_state().length_mm - abs(680.0 - axis_mm(20.0, 30.0)))
    assert np.std(draws) == pytest.approx(0.015, rel=0.12)


def test_a_second_motion_is_refused_while_one_runs() -> None:
    bench = quiet_bench()
    bench.move_to((20.0, 0.0, 0.0, 0.0))
    with pytest.raises(BenchError, match="moves already"):
        bench.move_to((0.0, 0.0, 0.0, 0.0))


def test_a_stop_decelerates_and_is_logged() -> None:
    said: list[str] = []
    config = without_j4_play(QUIET)
    bench = scara_bench(perfect_arm(), config, said.append)
    bench.stop()
    bench.move_to((90.0, 0.0, 0.0, 0.0), 50.0)
    bench.advance(0.2)
    here = bench.joints[0]
    bench.stop()
    assert bench.moving
    bench.advance(1.0)
    # 210 deg/s at 2000 deg/s²: 11.025 deg more.
    assert bench.joints[0] - here == pytest.approx(210.0**2 / 4000.0)
    assert [text.split()[0] for text in said] == ["motion", "stop", "arrival"]


def test_a_bench_without_reflectors_is_refused() -> None:
    config = EmulationConfig(reflectors=())
    with pytest.raises(BenchError, match="reflector"):
        scara_bench(perfect_arm(config), config)


def test_the_air_drifts_slowly_around_its_mean() -> None:
    bench = quiet_bench()
    samples = []
    for _ in range(200):
        bench.advance(60.0)
        samples.append(bench.air())
    temperatures = np.array([sample.temperature_c for sample in samples])
    assert abs(np.mean(temperatures) - 20.0) < 0.1
    assert 0.02 < np.std(temperatures) < 0.3
    assert np.max(np.abs(np.diff(temperatures))) < 0.2
    assert all(0.0 <= sample.humidity_percent <= 100.0 for sample in samples)


Act = Callable[[Bench], None]


def _move(bench: Bench, target: Joints) -> None:
    if not bench.moving:
        bench.move_to(target, 30.0)


targets = st.tuples(st.floats(15.0, 25.0), st.floats(25.0, 35.0)).map(lambda j: aimed(*j))
acts = st.one_of(
    targets.map(lambda target: ("move", target)),
    st.sampled_from([("stop", None), ("read", None), ("zero", None), ("block", None)]),
)
scripts = st.lists(st.tuples(acts, st.floats(0.0, 0.6)), min_size=1, max_size=8)


def play_script(script: list[tuple[tuple[str, Joints | None], float]], cuts: int) -> list[object]:
    """Carry out commands at fixed bench times, each wait cut into equal parts; return all that can be seen."""
    config = EmulationConfig(reflectors=(P1, P2, P3), seed=5, start_joints=aimed(20.0, 30.0))
    bench = scara_bench(draw_truth(5, config), config)
    seen: list[object] = []
    for (what, target), wait_s in script:
        if what == "move" and target is not None:
            _move(bench, target)
        elif what == "stop":
            bench.stop()
        elif what == "zero":
            seen.append(bench.beam.zero())
        elif what == "block":
            bench.beam.block(0.05)
        else:
            seen.append(_rounded(bench.beam.read()))
        until_s = bench.time_s + wait_s
        for part in range(1, cuts):
            bench.advance_to(until_s - wait_s * (1.0 - part / cuts))
        bench.advance_to(until_s)
    insight = bench.true_state()
    return [*seen, _rounded(bench.beam.read()), insight.reflector, *(round(q, 9) for q in insight.play)]


def _rounded(reading: Reading) -> tuple[object, ...]:
    value = round(reading.displacement_mm, 8)
    return (
        value,
        reading.returns,
        reading.beam_lost,
        reading.overspeed,
        round(reading.level, 6),
        reading.zero_id,
    )


@settings(max_examples=60)
@given(script=scripts, cuts=st.integers(2, 40))
def test_results_do_not_depend_on_the_steps_of_time(
    script: list[tuple[tuple[str, Joints | None], float]], cuts: int
) -> None:
    assert play_script(script, cuts) == play_script(script, 1)
