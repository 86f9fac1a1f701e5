"""Warming against the closed form of a first-order response, and against its differential equation."""

import math

import numpy as np
import pytest

from catseye.simulators.config import ArmDynamics
from catseye.simulators.world.motion import Motion, plan_glide, plan_motion, plan_stop
from catseye.simulators.world.warming import Warming

TAU_S = 1800.0
FASTEST = (100.0, 200.0)
DYNAMICS = ArmDynamics(max_speed=FASTEST, max_acceleration=(1000.0, 1000.0))


def level(warming: Warming, time_s: float) -> float:
    return float(warming.at(np.array([time_s]))[0])


def glide(way_deg: float, start_s: float, duration_s: float) -> Motion:
    return plan_glide((0.0, 0.0), (way_deg, 0.0), start_s, duration_s)


@pytest.mark.parametrize(("speed_deg_s", "heat"), [(100.0, 1.0), (50.0, 0.75), (1e-3, 0.500005)])
def test_warmth_follows_a_first_order_response(speed_deg_s: float, heat: float) -> None:
    warming = Warming(FASTEST, 40.0, TAU_S)
    warming.begin(glide(speed_deg_s * 7200.0, 10.0, 7200.0))
    for after_s in (0.0, 600.0, 1800.0, 7200.0):
        assert level(warming, 10.0 + after_s) == pytest.approx(heat * (1.0 - math.exp(-after_s / TAU_S)))
    warm = heat * (1.0 - math.exp(-4.0))
    assert level(warming, 7210.0 + 900.0) == pytest.approx(warm * math.exp(-0.5))


def test_an_arm_that_never_moved_is_cold() -> None:
    assert level(Warming(FASTEST, 40.0, TAU_S), 1e6) == 0.0


def test_growth_is_the_warmth_in_ppm() -> None:
    warming = Warming(FASTEST, 40.0, TAU_S)
    warming.begin(glide(1e7, 0.0, 1e5))
    grown = warming.growth(np.array([0.0, 1e5]))
    assert grown == pytest.approx([1.0, 1.00004], abs=1e-12)


def test_duty_warms_as_its_differential_equation_says() -> None:
    warming = Warming(FASTEST, 40.0, TAU_S)
    step_s, heat = 0.5, 0.5 + 0.5 * 0.3
    expected, time_s = 0.0, 0.0
    for _ in range(300):
        warming.begin(glide(30.0 * 4.0, time_s, 4.0))
        for n in range(20):
            # Euler's midpoint of dw/dt = (heat - w) / tau.
            driven = heat if n < 8 else 0.0
            half = expected + 0.5 * step_s * (driven - expected) / TAU_S
            expected += step_s * (driven - half) / TAU_S
        time_s += 10.0
    assert level(warming, time_s) == pytest.approx(expected, rel=1e-6)
    # Of 40 % duty, less the ripple of one cycle.
    assert expected == pytest.approx(0.4 * heat * (1.0 - math.exp(-3000.0 / TAU_S)), rel=5e-3)


def test_a_stop_ends_the_heat() -> None:
    stopped, whole = Warming(FASTEST, 40.0, TAU_S), Warming(FASTEST, 40.0, TAU_S)
    motion = plan_motion((0.0, 0.0), (1000.0, 0.0), 0.0, DYNAMICS)
    for warming in (stopped, whole):
        warming.begin(motion)
    stopped.begin(plan_stop(motion, 2.0, DYNAMICS))
    assert level(stopped, 2.0) == pytest.approx(level(whole, 2.0))
    assert level(stopped, 10.0) < 0.3 * level(whole, 10.0)


def test_looking_back_gives_the_same_warmth() -> None:
    warming = Warming(FASTEST, 40.0, TAU_S)
    times_s, seen = np.arange(0.5, 300.0, 1.0), []
    for time_s in times_s.tolist():
        if time_s % 10.0 == 0.5:
            warming.begin(glide(60.0, time_s, 3.0))
        seen.append(level(warming, time_s))
    np.testing.assert_allclose(warming.at(times_s), seen, rtol=1e-12)


def test_the_joint_nearest_to_its_largest_speed_counts() -> None:
    one, both = Warming(FASTEST, 40.0, TAU_S), Warming(FASTEST, 40.0, TAU_S)
    one.begin(plan_glide((0.0, 0.0), (50.0, 0.0), 0.0, 1.0))
    both.begin(plan_glide((0.0, 0.0), (50.0, 100.0), 0.0, 1.0))
    assert level(one, 1.0) == level(both, 1.0)
