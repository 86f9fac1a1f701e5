"""Patterns along the joints' angles and harmonics that a fit leaves, against what was put in."""

import math
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.diagnostics.harmonics import (
    Harmonic,
    HarmonicSeries,
    aliased_orders,
    harmonic_series,
)
from catseye.calibration.scara.diagnostics.joint_angles import angle_patterns
from catseye.calibration.scara.diagnostics.projection import projection_of
from catseye.calibration.scara.points import Points
from tests.unit.calibration.scara.diagnostics.bench import (
    Extra,
    commands_between,
    commands_on_nodes,
    measured,
    problem,
    with_noise,
)
from tests.unit.calibration.scara.paper import MDEG, NOMINAL_REFLECTORS, random_truth
from tests.unit.calibration.scara.reversal import HALF_TURN, AxisMotion, mounted

TRUTH = random_truth(8)
NOMINAL = (325.0, 225.0)


def series_of(points: Points, orders: int = 60, budget: Budget | None = None) -> dict[str, HarmonicSeries]:
    identified = replace(problem(points), budget=budget).solve()
    found = harmonic_series(projection_of(identified), NOMINAL, NOMINAL_REFLECTORS, orders)
    return {f"{one.target}({one.source})": one for one in found}


def strongest(series: HarmonicSeries) -> Harmonic | None:
    """Return the clearest order."""
    return min(series.harmonics, key=lambda one: (one.probability, -one.explained_um), default=None)


def test_a_periodic_error_between_nodes_is_identified() -> None:
    extra = Extra(theta1=lambda p: 4.0 * MDEG * math.cos(36 * p.theta1 + 0.7))
    points = measured(TRUTH, commands_between(), extra, noise_mm=0.005, sigma_mm=0.005)
    found = series_of(points)
    best = strongest(found["theta1(theta1)"])
    assert best is not None
    assert best.order == 36
    assert best.significant
    assert best.amplitude == pytest.approx(4.0 * MDEG, abs=4.0 * best.u)
    others = [strongest(found[name]) for name in ("theta2(theta2)", "length(theta4)")]
    assert not any(one.significant for one in others if one is not None)


def test_maps_on_nodes_absorb_their_own_joints_orders() -> None:
    points = measured(TRUTH, commands_on_nodes(), noise_mm=0.005, sigma_mm=0.005)
    found = series_of(points)
    assert found["theta1(theta1)"].harmonics == ()
    assert set(range(1, 61)) - set(found["theta1(theta1)"].absorbed) <= {18, 36, 54}
    assert [one.order for one in found["theta1(theta2)"].harmonics] == list(range(1, 10))


def test_crosstalk_shows_as_a_harmonic_of_the_other_joint() -> None:
    extra = Extra(theta2=lambda p: 3.0 * MDEG * math.sin(2 * p.theta1))
    found = series_of(measured(TRUTH, commands_on_nodes(), extra, noise_mm=0.005, sigma_mm=0.005))
    best = strongest(found["theta2(theta1)"])
    assert best is not None
    assert (best.order, best.significant) == (2, True)
    assert best.amplitude == pytest.approx(3.0 * MDEG, abs=4.0 * best.u)


def test_radial_motion_of_j4_is_no_harmonic_beside_its_budget() -> None:
    extra = Extra(length=lambda p: 0.012 * math.cos(3 * p.beam))
    points = measured(TRUTH, commands_on_nodes(), extra, noise_mm=0.008, sigma_mm=0.008)
    budget = Budget((Contributor("J4", "radial", 0.010, "axis-angle", "j4"),))
    plain, stated = series_of(points)["length(theta4)"], series_of(points, budget=budget)["length(theta4)"]
    best = strongest(plain)
    assert best is not None
    assert (best.order, best.significant) == (3, True)
    assert not any(one.significant for one in stated.harmonics)


def test_a_motion_of_j4_is_one_harmonic_in_both_mountings() -> None:
    motion = AxisMotion([(0.0, 0.0)] * 3, [(0.0, 0.0)] * 2 + [(0.012, 0.0)])
    points = mounted(TRUTH, motion.longer, [0.0, HALF_TURN], 0.008, 2)
    identified = problem(replace(points, sigma_mm=np.full(len(points), 0.008))).solve()
    projection = projection_of(identified)
    length = harmonic_series(projection, NOMINAL, NOMINAL_REFLECTORS, 8)[-1]
    # Order 3 of the motion, in y alone, is half in order 2 and half in order 4 of the distance.
    for order in (2, 4):
        (found,) = (one for one in length.harmonics if one.order == order)
        assert found.significant
        assert found.amplitude == pytest.approx(0.006, abs=4.0 * found.u)
    *_, pattern = angle_patterns(projection, NOMINAL, NOMINAL_REFLECTORS)
    assert pattern.significant
    assert np.abs(pattern.angle_deg).max() <= 180.0


def test_white_noise_raises_no_alarm() -> None:
    exact, alarms = measured(TRUTH, commands_on_nodes(), sigma_mm=0.01), 0
    for seed in range(10):
        found = series_of(with_noise(exact, 0.01, seed), 30)
        alarms += sum(h.significant for one in found.values() for h in one.harmonics)
    assert alarms <= 1


def test_orders_that_a_20_degree_grid_cannot_distinguish() -> None:
    groups = dict(aliased_orders(np.deg2rad(np.arange(-140.0, 61.0, 20.0)), range(1, 41)))
    # Waves on angles 20° apart repeat after 18 orders and fold at 9; orders 18 and 36 are constant there.
    assert groups[1] == (17, 19, 35, 37)
    assert groups[4] == (14, 22, 32, 40)
    assert sorted(groups) == list(range(1, 10))


def test_orders_of_scattered_angles_are_all_different() -> None:
    angles = np.random.default_rng(1).uniform(-2.0, 1.0, 300)
    groups = aliased_orders(angles, range(1, 41))
    assert groups == [(order, ()) for order in range(1, 41)]


def test_pattern_against_the_beam_angle() -> None:
    extra = Extra(length=lambda p: 0.012 * math.cos(3 * p.beam))
    points = measured(TRUTH, commands_on_nodes(), extra, noise_mm=0.006, sigma_mm=0.006)
    projection = projection_of(problem(points).solve())
    patterns = {one.joint: one for one in angle_patterns(projection, NOMINAL, NOMINAL_REFLECTORS)}
    assert patterns[4].significant
    assert patterns[4].explained_um == pytest.approx(12.0 / math.sqrt(2.0), rel=0.25)
    assert patterns[1].count.tolist() == [96] * 11
    own = np.abs(np.rad2deg(points.commands.theta1_rad) - 20.0) < 1e-6
    mean = 1e3 * float(np.mean(problem(points).solve().residuals_mm[own]))
    assert patterns[1].mean_um[8] == pytest.approx(mean, abs=1e-6)


def test_white_noise_has_no_pattern() -> None:
    points = measured(TRUTH, commands_on_nodes(), noise_mm=0.01, sigma_mm=0.01)
    projection = projection_of(problem(points).solve())
    assert not any(one.significant for one in angle_patterns(projection, NOMINAL, NOMINAL_REFLECTORS))
