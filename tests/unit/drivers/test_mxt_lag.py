"""Lags of joints learned from ways, against a servo whose lag is known, and what set points make up for."""

import itertools
import math
from collections.abc import Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from catseye.drivers.melfa.mxt.lag import NO_DELAYS, Floats, LagLearner, WayTrace, lag_of
from catseye.drivers.melfa.mxt.profile import Bounds, WayProfile, excess
from catseye.drivers.roles.pose import Pose

CYCLE_S = 0.0071
BOUNDS = Bounds((20.0, 20.0, 50.0, 20.0), (200.0, 200.0, 500.0, 200.0))
START: Pose = (0.0, 0.0, 5.0, 0.0)
WAY: tuple[Pose, ...] = ((10.0, -8.0, 5.0, 15.0), (20.0, -20.0, 5.0, 24.0))
REST_CYCLES = 60


class Servo:
    """A joint that follows late and slowly: a pure delay, then a first-order lag, worked out in steps of 0.1 ms."""

    STEPS = 71

    def __init__(self, start: float, delay_s: float, constant_s: float) -> None:
        step_s = CYCLE_S / self.STEPS
        self._delayed = [start] * (1 + round(delay_s / step_s))
        self._share = 1.0 - math.exp(-step_s / constant_s) if constant_s else 1.0
        self._at, self._last = start, start

    def cycle(self, point: float) -> float:
        """Take a set point, to which the command goes straight; return where the joint is at the end."""
        for step in range(1, self.STEPS + 1):
            self._delayed.append(self._last + (point - self._last) * step / self.STEPS)
            self._at += self._share * (self._delayed.pop(0) - self._at)
        self._last = point
        return self._at


def driven(
    delays_s: Pose,
    constants_s: Pose,
    way: Sequence[Pose] = WAY,
    *,
    shifts_s: Pose = NO_DELAYS,
    noise: float = 0.0,
) -> tuple[WayTrace, list[Pose]]:
    """Drive a way with servos; return its trace and where the joints were in each cycle."""
    rng = np.random.default_rng(4)
    servos = [Servo(*one) for one in zip(START, delays_s, constants_s, strict=True)]
    points = WayProfile(START, way, BOUNDS).set_points(CYCLE_S, shifts_s)
    trace, passed = WayTrace(), list[Pose]()
    for point in [*points, *[way[-1]] * REST_CYCLES]:
        one, two, three, four = (servo.cycle(value) for servo, value in zip(servos, point, strict=True))
        passed.append((one, two, three, four))
        shown = np.array(passed[-1]) + noise * rng.standard_normal(4)
        trace.add(point, tuple(shown.tolist()), 0)
    return trace, passed


@pytest.mark.parametrize(
    ("delay_s", "constant_s"), [(0.0, 0.0), (0.0, 0.008), (0.0142, 0.0), (0.0071, 0.0082), (0.03, 0.02)]
)
def test_the_learned_lag_is_delay_and_time_constant(delay_s: float, constant_s: float) -> None:
    trace, _ = driven((delay_s,) * 4, (constant_s,) * 4)
    learner = LagLearner(CYCLE_S, 0.003)
    learner.take(trace)
    # For slow commands a first-order lag is a delay by its time constant.
    for joint in (0, 1, 3):
        assert learner.lags_s[joint] == pytest.approx(delay_s + constant_s, abs=1.5e-4)
    assert learner.lags_s[2] is None


def test_differences_between_joints_are_learned_to_microseconds() -> None:
    trace, _ = driven(NO_DELAYS, (0.008, 0.0082, 0.008, 0.0079))
    learner = LagLearner(CYCLE_S, 0.003)
    learner.take(trace)
    one, two, three, four = learner.delays_s
    assert (one, two, four) == pytest.approx((0.0002, 0.0, 0.0003), abs=5e-6)
    assert two <= three <= four


def test_joints_with_learned_delays_pass_the_way_together() -> None:
    constants_s = (0.008, 0.010, 0.008, 0.007)
    straight = (WAY[-1],)
    trace, before = driven(NO_DELAYS, constants_s, straight)
    learner = LagLearner(CYCLE_S, 0.003)
    learner.take(trace)
    _, after = driven(NO_DELAYS, constants_s, straight, shifts_s=learner.delays_s)
    assert apart_deg(after) < 0.1 * apart_deg(before)
    assert after[-1] == pytest.approx(WAY[-1], abs=1e-6)


def apart_deg(passed: Sequence[Pose]) -> float:
    """Return by how much J2 or J4 is beside the place of the straight way at which J1 is."""
    end, joints = np.array(WAY[-1]), np.array(passed)
    beside = joints[:, (1, 3)] - joints[:, :1] / end[0] * end[[1, 3]]
    return float(np.abs(beside).max())


def test_noise_of_the_encoders_is_averaged_out() -> None:
    trace, _ = driven(NO_DELAYS, (0.008, 0.0082, 0.008, 0.0079), noise=0.002)
    learner = LagLearner(CYCLE_S, 0.003)
    learner.take(trace)
    assert learner.delays_s[0] == pytest.approx(0.0002, abs=6e-5)


def test_ways_of_one_connection_are_pooled() -> None:
    once, twice = LagLearner(CYCLE_S, 0.003), LagLearner(CYCLE_S, 0.003)
    first, _ = driven(NO_DELAYS, (0.008,) * 4, noise=0.01)
    second, _ = driven(NO_DELAYS, (0.008,) * 4, way=(WAY[0],), noise=0.01)
    for learner, traces in ((once, (first,)), (twice, (first, second))):
        for trace in traces:
            learner.take(trace)
    longer, shorter, both = once.lags_s[0], lag_of(*_joint(second, 0), CYCLE_S), twice.lags_s[0]
    assert longer is not None
    assert shorter is not None
    assert both is not None
    assert min(longer, shorter.lag_s) < both < max(longer, shorter.lag_s)


def _joint(trace: WayTrace, number: int) -> tuple[Floats, Floats]:
    joint = trace.joint(number)
    assert joint is not None
    return joint


def test_implausible_differences_are_not_made_up_for() -> None:
    trace, _ = driven((0.0, 0.01, 0.0, 0.0), (0.008,) * 4)
    learner = LagLearner(CYCLE_S, 0.003)
    learner.take(trace)
    assert learner.difference_s == pytest.approx(0.01, abs=1e-4)
    assert not learner.plausible
    assert learner.delays_s == NO_DELAYS


def test_a_joint_that_stays_behind_teaches_nothing() -> None:
    sent = np.linspace(0.0, 10.0, 100)
    assert lag_of(sent, np.zeros(100), CYCLE_S) is None
    assert lag_of(sent, sent + 1.0, CYCLE_S) is None


@pytest.mark.parametrize("broken", ["lost", "missed"])
def test_ways_with_missing_cycles_teach_nothing(broken: str) -> None:
    trace, _ = driven(NO_DELAYS, (0.008,) * 4)
    if broken == "lost":
        trace.lose()
    else:
        trace.add(WAY[-1], WAY[-1], 3)
    learner = LagLearner(CYCLE_S, 0.003)
    learner.take(trace)
    assert learner.lags_s == (None,) * 4
    assert learner.delays_s == NO_DELAYS


def test_small_ways_teach_nothing() -> None:
    trace, _ = driven(NO_DELAYS, (0.008,) * 4, way=((0.2, 0.2, 5.0, -0.2),))
    learner = LagLearner(CYCLE_S, 0.003)
    learner.take(trace)
    assert learner.lags_s == (None,) * 4


joints = st.tuples(*[st.floats(-170.0, 170.0)] * 2, st.floats(0.0, 150.0), st.floats(-360.0, 360.0))
delays = st.tuples(*[st.floats(0.0, 0.01)] * 4)


@given(start=joints, way=st.lists(joints, min_size=1, max_size=5), delays_s=delays)
@settings(max_examples=60, deadline=None)
def test_delayed_set_points_leave_neither_way_nor_speed(start: Pose, way: list[Pose], delays_s: Pose) -> None:
    points = WayProfile(start, way, BOUNDS).set_points(CYCLE_S, delays_s)
    assert excess(points, start, way, BOUNDS, CYCLE_S) == ""
    assert (points or [start])[-1] == pytest.approx(way[-1], abs=1e-9)
    for axis, (low, high) in enumerate(
        zip(np.min([start, *way], axis=0), np.max([start, *way], axis=0), strict=True)
    ):
        values = [point[axis] for point in points]
        assert all(low - 1e-9 <= value <= high + 1e-9 for value in values)
        steps = [abs(b - a) for a, b in itertools.pairwise([start[axis], *values])]
        assert max(steps, default=0.0) <= BOUNDS.speed[axis] * CYCLE_S + 1e-9


@pytest.mark.parametrize(
    ("points", "said"),
    [
        ([(0.1, 0.0, 5.0, 0.0), (-0.001, 0.0, 5.0, 0.0)], "J1 lies 0.001 outside"),
        ([(0.1, 0.0, 5.0, 0.0), (0.3, 0.0, 5.0, 0.0)], "J1 is 0.058 too far"),
        ([(0.1, 0.0, 5.0, 24.001)], "J4 lies 0.001 outside"),
        ([(0.1, float("nan"), 5.0, 0.0)], "J2 lies nan outside"),
    ],
)
def test_set_points_beside_the_way_are_refused(points: list[Pose], said: str) -> None:
    assert said in excess(points, START, WAY, BOUNDS, CYCLE_S)
