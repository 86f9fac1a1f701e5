"""The arm's errors against independent calculation."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.simulators.config import EmulationConfig, ErrorBudget
from catseye.simulators.world.bench import Bench
from catseye.simulators.world.scara.arm import ScaraArm, scara_bench
from catseye.simulators.world.scara.axis_errors import JointMap, RadialError
from catseye.simulators.world.scara.truth import TrueArm, draw_truth
from tests.unit.simulators.benches import (
    QUIET,
    axis_mm,
    calibration_map,
    constant_map,
    go,
    perfect_arm,
    quiet_bench,
    without_j4_play,
)

MDEG = math.pi / 180e3


def deviations_mdeg(bench: Bench) -> tuple[float, float]:
    """Return the true deviations of J1 and J2 at this moment."""
    true, command = bench.true_state().joints, bench.joints
    return (true[0] - command[0]) * 1e3, (true[1] - command[1]) * 1e3


def played_arm() -> TrueArm:
    return replace(perfect_arm(), theta1_map=constant_map(-3.0, 3.0), theta2_map=constant_map(-2.0, 4.0))


def test_the_perfect_arm_is_where_the_geometry_says() -> None:
    bench = quiet_bench()
    go(bench, (30.0, 60.0, 0.0, 10.0))
    insight = bench.true_state()
    # 325 cos 30 + 225 cos 90, 325 sin 30 + 225 sin 90.
    assert insight.axis_mm == pytest.approx((281.458256, 387.5), abs=1e-6)
    assert insight.beam_deg == pytest.approx(100.0)


def test_play_starts_negative_and_changes_over_its_travel() -> None:
    bench = quiet_bench(truth=played_arm())
    assert deviations_mdeg(bench)[0] == pytest.approx(3.0)
    go(bench, (0.025, 0.0, 0.0, 0.0))
    assert deviations_mdeg(bench)[0] == pytest.approx(0.0, abs=1e-9)
    go(bench, (0.015, 0.0, 0.0, 0.0))
    assert deviations_mdeg(bench)[0] == pytest.approx(1.2)
    go(bench, (10.0, 0.0, 0.0, 0.0))
    assert deviations_mdeg(bench)[0] == pytest.approx(-3.0)


def test_a_joint_at_rest_keeps_its_flank() -> None:
    bench = quiet_bench(truth=played_arm())
    go(bench, (10.0, 10.0, 0.0, 0.0))
    go(bench, (-10.0, 10.0, 0.0, 0.0))
    assert deviations_mdeg(bench) == pytest.approx((3.0, -2.0))


def test_a_wide_gap_between_the_tables_widens_the_travel() -> None:
    truth = replace(perfect_arm(), theta1_map=constant_map(-100.0, 100.0))
    bench = quiet_bench(truth=truth)
    go(bench, (0.1, 0.0, 0.0, 0.0))
    # The flanks are 0.2 deg apart: half of the travel is used.
    assert deviations_mdeg(bench)[0] == pytest.approx(0.0, abs=1e-9)


def test_a_joint_stopped_while_reversing_stays_between_flanks() -> None:
    bench = quiet_bench(truth=played_arm())
    go(bench, (10.0, 0.0, 0.0, 0.0))
    bench.move_to((9.0, 0.0, 0.0, 0.0), 1.0)
    while bench.joints[0] > 9.99:
        bench.advance(1e-4)
    bench.stop()
    bench.advance(1.0)
    travelled_deg = 10.0 - bench.joints[0]
    assert 0.01 < travelled_deg < 0.05
    assert deviations_mdeg(bench)[0] == pytest.approx(-3.0 + 6.0 * travelled_deg / 0.05)


def stepwise_play(angles_deg: list[float], travel_deg: float, steps: int = 400) -> float:
    """Integrate the play operator in small steps, the textbook way."""
    play, here = -1.0, 0.0
    for angle in angles_deg:
        for _ in range(steps):
            play = min(1.0, max(-1.0, play + 2.0 * (angle - here) / steps / travel_deg))
        here = angle
    return play


@given(st.lists(st.floats(-0.2, 0.2), min_size=1, max_size=8))
def test_play_equals_its_stepwise_integration(angles_deg: list[float]) -> None:
    bench = quiet_bench(truth=played_arm())
    for angle in angles_deg:
        go(bench, (angle, 0.0, 0.0, 0.0), 5.0)
    assert bench.true_state().play[0] == pytest.approx(stepwise_play(angles_deg, 0.05), abs=1e-9)


def test_maps_are_those_of_the_calibration_on_both_flanks() -> None:
    truth = draw_truth(3, QUIET)
    bench = quiet_bench(truth=truth)
    for target, direction in ((33.3, 1), (-71.7, -1)):
        go(bench, (target, target, 0.0, 0.0))
        angle, state = np.array([math.radians(target)]), np.array([direction])
        maps = map(calibration_map, (truth.theta1_map, truth.theta2_map))
        expected = [float(m.deviation(angle, state)[0]) / MDEG for m in maps]
        assert deviations_mdeg(bench) == pytest.approx(expected, abs=1e-9)


def test_a_map_is_held_constant_outside_its_nodes() -> None:
    nodes = np.deg2rad(np.array([-10.0, 10.0]))
    table = JointMap(nodes, np.array([1.0, 2.0]) * MDEG, np.array([1.0, 2.0]) * MDEG)
    bench = quiet_bench(truth=replace(perfect_arm(), theta1_map=table))
    go(bench, (50.0, 0.0, 0.0, 0.0))
    assert deviations_mdeg(bench)[0] == pytest.approx(2.0)


def arrivals(budget: ErrorBudget, count: int = 400) -> np.ndarray[tuple[int], np.dtype[np.complex128]]:
    config = replace(QUIET, budget=budget)
    bench = quiet_bench(config)
    places = []
    for turn in range(count):
        go(bench, (float(turn % 2), 0.0, 0.0, 0.0), 100.0)
        places.append(complex(*bench.true_state().axis_mm) - axis_mm(float(turn % 2), 0.0))
    return np.array(places)


def test_each_arrival_scatters_as_the_budget_says() -> None:
    errors_mm = arrivals(replace(ErrorBudget.none(), repeatability_um=10.0))
    # 400 draws: the standard deviation is known to 3.5 %.
    assert np.std(errors_mm.real) == pytest.approx(0.010, rel=0.12)
    assert np.std(errors_mm.imag) == pytest.approx(0.010, rel=0.12)
    assert abs(np.mean(errors_mm)) < 0.003


def test_at_rest_nothing_scatters() -> None:
    bench = quiet_bench(replace(QUIET, budget=replace(ErrorBudget.none(), repeatability_um=10.0)))
    go(bench, (20.0, 0.0, 0.0, 0.0))
    before = bench.true_state().axis_mm
    bench.advance(100.0)
    assert bench.true_state().axis_mm == before


@pytest.mark.parametrize("rms_um", [5.0, 10.0])
def test_radial_error_has_its_rms_and_closes(rms_um: float) -> None:
    error = RadialError(np.random.default_rng(4), rms_um)
    shifts_um = 1e3 * error.shift_mm(np.linspace(0.0, 360.0, 3601)[:-1])
    assert np.sqrt(np.mean(shifts_um.real**2)) == pytest.approx(rms_um, rel=1e-3)
    assert np.sqrt(np.mean(shifts_um.imag**2)) == pytest.approx(rms_um, rel=1e-3)
    ends = error.shift_mm(np.array([-360.0, 0.0, 360.0]))
    assert ends == pytest.approx([ends[0]] * 3)


def test_radial_errors_turn_with_the_link_that_carries_them() -> None:
    """J2's shift lies in link 1, J4's in link 2: turning J1 by 90 deg turns both by 90 deg."""
    for radial_um in ((0.0, 10.0, 0.0), (0.0, 0.0, 10.0)):
        budget = replace(ErrorBudget.none(), radial_um=radial_um)
        bench = quiet_bench(replace(QUIET, budget=budget))
        go(bench, (0.0, 40.0, 0.0, 25.0))
        first = complex(*bench.true_state().axis_mm) - axis_mm(0.0, 40.0)
        go(bench, (90.0, 40.0, 0.0, 25.0))
        second = complex(*bench.true_state().axis_mm) - axis_mm(90.0, 40.0)
        assert abs(first) > 1e-3
        assert second == pytest.approx(1j * first, abs=1e-9)


def test_links_grow_with_the_time_constant_of_work() -> None:
    budget = replace(ErrorBudget.none(), thermal_k=4.0, thermal_time_s=3600.0)
    bench = quiet_bench(replace(QUIET, budget=budget))
    bench.follow(np.array([3600.0]), np.array([[0.0, 0.0, 0.0, 1e-6]]))
    bench.advance(3600.0)
    # 550 mm · 11.7e-6 1/K · 4 K · (1 - 1/e), of which slow drives heat half.
    assert bench.true_state().axis_mm[0] - 550.0 == pytest.approx(
        550.0 * 11.7e-6 * 4.0 * 0.5 * (1.0 - math.exp(-1.0)), rel=1e-6
    )


def test_links_of_an_arm_at_rest_stay_cold() -> None:
    bench = quiet_bench(replace(QUIET, budget=replace(ErrorBudget.none(), thermal_k=4.0)))
    bench.advance(36_000.0)
    assert bench.true_state().axis_mm[0] == pytest.approx(550.0, abs=1e-9)


def test_the_arm_rings_after_a_motion_and_calms_down() -> None:
    budget = replace(ErrorBudget.none(), vibration_um=20.0)
    bench = quiet_bench(replace(QUIET, budget=budget))
    go(bench, (20.0, 0.0, 0.0, 0.0))
    start = bench.standstill_s
    swings_um = []
    for step in range(1, 60):
        bench.advance_to(start + step * 1e-3)
        swings_um.append(1e3 * abs(complex(*bench.true_state().axis_mm) - axis_mm(20.0, 0.0)))
    # The first crest comes a little before a quarter of 1/15 s.
    assert max(swings_um) == pytest.approx(20.0 * math.exp(-0.0162 / 0.08), rel=0.02)
    bench.advance(1.0)
    assert 1e3 * abs(complex(*bench.true_state().axis_mm) - axis_mm(20.0, 0.0)) < 1e-3


def test_ringing_goes_on_into_the_next_motion_without_a_jump() -> None:
    budget = replace(ErrorBudget.none(), vibration_um=20.0)
    bench = quiet_bench(replace(QUIET, budget=budget))
    go(bench, (20.0, 0.0, 0.0, 0.0))
    bench.advance(0.01)
    before = bench.true_state().axis_mm
    bench.move_to((0.0, 0.0, 0.0, 0.0), 100.0)
    assert bench.true_state().axis_mm == pytest.approx(before, abs=1e-9)


def test_the_seed_determines_the_arm() -> None:
    def place(seed: int) -> tuple[float, float]:
        config = EmulationConfig(reflectors=QUIET.reflectors, seed=seed)
        bench = scara_bench(draw_truth(seed, config), config)
        go(bench, (45.0, 45.0, 0.0, 45.0))
        return bench.true_state().axis_mm

    assert place(1) == place(1)
    assert place(1) != place(2)


def test_looks_at_the_beam_are_fine_enough() -> None:
    arm = ScaraArm(perfect_arm(), without_j4_play(QUIET))
    arm.move_to((20.0, 10.0, 0.0, -40.0), 0.0, 1.0, 1.0)
    times = arm.sample_times()
    joints = np.array([arm.motion.joints_at(float(t)) for t in times])
    assert np.max(np.abs(np.diff(joints[:, [0, 1, 3]], axis=0))) <= 0.05 + 1e-9
    assert np.max(np.diff(times)) <= 0.005 + 1e-9
    assert times[-1] >= arm.motion.end_s
