"""Least increment steps of joints whose mean step error is written down."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.decaying import DecayingTest, decaying_test
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.mean_curve import scatter_percent
from tests.unit.calibration.resolution.measured import decaying_steps, measured_steps
from tests.unit.calibration.resolution.staircase import DEG, STEPS_DEG

COMMAND = STEPS_DEG * DEG
ALL = np.ones(STEPS_DEG.size, dtype=np.bool_)


LEVEL: Floats = -12.0 * np.exp(-2.0 * np.log(np.maximum(STEPS_DEG / 3e-4, 1.0)))
"""Mean error of a joint that makes small steps too short by 12 %, %."""

MEANS = (LEVEL, LEVEL * (1.0 + 0.6 * np.log(np.maximum(3e-4 / STEPS_DEG, 1.0))), -12.0 * 3e-4 / STEPS_DEG)
"""Mean errors that level off, go on as the logarithm of the step, and are the same angle at every step, %."""


def overtravel(size_deg: float, scatter_deg: float, seed: int) -> Floats:
    """Return step errors of a joint that goes too far by so much, whatever the step, and scatters, %."""
    noise = np.random.default_rng(seed).normal(0.0, scatter_deg, STEPS_DEG.size)
    return 100.0 * (size_deg + noise) / STEPS_DEG


def evaluated(errors: Floats, threshold: float = 10.0, u_step_deg: float = 0.0) -> DecayingTest:
    return decaying_test(decaying_steps(COMMAND, errors, u_step_deg * DEG), threshold)


def kinds(found: DecayingTest) -> set[str]:
    return {flag.kind for flag in found.flags}


@pytest.mark.parametrize("threshold", [5.0, 10.0, 25.0])
def test_without_scatter_the_least_step_is_where_the_mean_leaves(threshold: float) -> None:
    # The moving mean of 1/Δ over 11 steps of ratio r is (r⁵ + … + r⁻⁵)/11 = 1.0496 times that in its middle.
    factor = float(np.mean(1.072267 ** np.arange(-5.0, 6.0)))
    expected = STEPS_DEG[100.0 * 1e-4 * factor / STEPS_DEG <= threshold].min()
    found = evaluated(overtravel(1e-4, 1e-7, 1), threshold)
    assert found.by_rule == pytest.approx(expected * DEG)
    assert found.least_step is not None
    assert found.least_step.value == pytest.approx(expected * DEG)
    assert found.least_step.high < 1.08 * found.least_step.value < 1.2 * found.least_step.low


def scattered(mean_percent: Floats, scatter_percent: float, seed: int) -> Floats:
    """Return step errors of a joint about their mean, %."""
    return np.asarray(mean_percent + np.random.default_rng(seed).normal(0.0, scatter_percent, STEPS_DEG.size))


def true_least_step(mean_percent: Floats) -> float:
    """Return the least step of a mean error by the paper's rule, written out, rad."""
    means = np.array([np.mean(mean_percent[max(0, k - 5) : k + 6]) for k in range(STEPS_DEG.size)])
    return float(COMMAND[int(np.argmax(np.abs(means) > 10.0)) - 1])


def test_intervals_hold_as_often_as_they_say() -> None:
    true = true_least_step(100.0 * 1e-4 / STEPS_DEG)
    held, apart = [], []
    for seed in range(120):
        least = evaluated(overtravel(1e-4, 1e-4, seed)).least_step
        assert least is not None
        held.append(least.low <= true <= least.high)
        apart.append(np.log(least.value / true) / np.log(1.072267))
    # 120 draws of a probability of 0.95: 107 or fewer happen once in 100, all of them once in 470.
    assert 107 < sum(held) < 120
    assert abs(np.median(apart)) <= 1.0


DISTURBANCES = {
    "40 % once": ({80: 40.0}, (81,)),
    "160 % once": ({80: 160.0}, (81,)),
    "160 % once, farther up": ({70: 160.0}, (71,)),
    "stuck, then made up for": ({80: -100.0, 81: 107.2267}, (81, 82)),
    "stuck, then made up for farther up": ({70: -100.0, 71: 107.2267}, (71, 72)),
}


@pytest.mark.parametrize("name", DISTURBANCES)
def test_intervals_hold_although_a_step_is_disturbed(name: str) -> None:
    off, numbers = DISTURBANCES[name]
    held, named, by_rule = [], [], []
    for mean, seed in product(MEANS, range(14)):
        errors, true = scattered(mean, 3.0, seed), true_least_step(mean)
        for place, percent in off.items():
            errors[place] += percent
        found = evaluated(errors)
        assert found.least_step is not None
        assert found.by_rule is not None
        held.append(found.least_step.low <= true <= found.least_step.high)
        by_rule.append(found.least_step.low <= found.by_rule <= found.least_step.high)
        named.append([flag.moves for flag in found.flags if flag.kind == "disturbed"] == [numbers])
    # 42 draws of a probability of 0.95: 36 or fewer happen once in 60.
    assert sum(held) >= 37
    assert sum(named) >= 40
    assert all(by_rule)


def test_a_stuck_step_made_up_for_is_one_disturbance() -> None:
    errors = scattered(LEVEL, 1.0, 3)
    errors[70] -= 100.0
    errors[71] += 107.2267
    (flag,) = [flag for flag in evaluated(errors).flags if flag.kind == "disturbed"]
    assert "moves 71, 72: not made in full, and the next one made up for it" in flag.text


def test_a_disturbed_step_of_the_tool_is_named() -> None:
    command = np.asarray(1.0 / 1.072267 ** np.arange(109.0))
    done = command * (1.0 + np.random.default_rng(2).normal(0.0, 0.03, command.size))
    done[60] += command[60]
    found = decaying_test(measured_steps(command, np.concatenate([[0.0], np.cumsum(done)]), 1e-7, "mm"))
    assert [flag.moves for flag in found.flags if flag.kind == "disturbed"] == [(61,)]


def test_a_joint_that_sticks_time_and_again_is_not_flattered() -> None:
    errors = np.random.default_rng(4).normal(0.0, 2.0, STEPS_DEG.size)
    errors[[60, 65, 70, 75, 80]] -= 100.0
    found = evaluated(errors)
    (flag,) = [flag for flag in found.flags if flag.kind == "disturbed"]
    assert flag.moves == (61, 66, 71, 76, 81)
    assert "count as what the joint does" in flag.text
    # With two of them in a window of 11 the mean is −18 %, from the 61st to the 75th step.
    assert found.least_step is not None
    assert found.least_step.high > COMMAND[61]


@pytest.mark.parametrize("seed", range(8))
def test_scatter_that_is_normal_disturbs_no_step(seed: int) -> None:
    for errors in (scattered(LEVEL, 3.0, seed), overtravel(1e-4, 1e-4, seed), overtravel(1e-4, 1e-9, seed)):
        assert "disturbed" not in kinds(evaluated(errors))


@pytest.mark.parametrize("scatter_percent", [0.5, 2.0, 5.0])
@pytest.mark.parametrize("followed", [30, 60, 80, 100, 106])
def test_a_joint_that_stops_following_has_its_least_step(followed: int, scatter_percent: float) -> None:
    # The window reaches 5 steps on: with one that is not made the mean is −9.1 %, with two −18 %.
    errors = np.random.default_rng(followed).normal(0.0, scatter_percent, STEPS_DEG.size)
    errors[followed:] = -100.0
    found = evaluated(errors, u_step_deg=1e-9)
    least = found.least_step
    assert least is not None
    true = STEPS_DEG[followed - 5] * DEG
    assert 0.0 < least.low <= least.value <= least.high
    assert abs(math.log(least.value / true) / math.log(1.072267)) < 1.5
    assert least.low <= true * 1.0723
    assert least.high >= true / 1.0723


@pytest.mark.parametrize("followed", [60, 100])
def test_an_end_without_any_step_is_named(followed: int) -> None:
    errors = np.random.default_rng(2).normal(0.0, 2.0, STEPS_DEG.size)
    errors[followed:] = -100.0
    assert evaluated(errors, u_step_deg=1e-9).stopped_at == followed + 1


@pytest.mark.parametrize(
    ("growing", "left"),
    [
        # The mean error has left the threshold before the end, which gives no least step.
        (True, -100.0),
        # Something is left of each step.
        (False, -70.0),
    ],
)
def test_an_end_that_gives_no_least_step_is_none(growing: bool, left: float) -> None:
    errors = overtravel(1e-3 if growing else 0.0, 1e-6, 1)
    errors[80:] = left
    assert evaluated(errors, u_step_deg=1e-9).stopped_at is None


def test_the_moving_mean_and_spread_are_those_of_eleven_steps() -> None:
    errors = overtravel(1e-4, 1e-4, 3)
    found = evaluated(errors)
    assert found.mean_percent[50] == pytest.approx(errors[45:56].mean())
    assert found.mean_percent[0] == pytest.approx(errors[:6].mean())
    means = found.mean_percent[45:56]
    assert found.spread_percent[50] == pytest.approx(np.sqrt(np.mean((errors[45:56] - means) ** 2)))


def test_ends_of_the_moving_mean_are_flagged() -> None:
    (flag,) = [one for one in evaluated(overtravel(1e-4, 1e-4, 3)).flags if one.kind == "partial-mean"]
    assert flag.moves == (1, 2, 3, 4, 5, 105, 106, 107, 108, 109)


def test_steps_below_the_instrument_take_no_part() -> None:
    errors = overtravel(1e-6, 1e-5, 1)
    found = evaluated(errors, u_step_deg=1e-4)
    assert np.isnan(found.error_percent[STEPS_DEG < 3e-4]).all()
    assert found.least_step is not None
    assert found.least_step.low == 0.0
    assert found.least_step.value == pytest.approx(STEPS_DEG[STEPS_DEG >= 3e-4].min() * DEG)
    assert "least-step-open" in kinds(found)


def test_the_rule_ends_at_the_smallest_judged_step() -> None:
    found = evaluated(overtravel(1e-6, 1e-6, 1), u_step_deg=1e-4)
    assert found.by_rule == pytest.approx(STEPS_DEG[STEPS_DEG >= 3e-4].min() * DEG)


def test_a_joint_beyond_the_threshold_everywhere_has_none() -> None:
    found = evaluated(20.0 + overtravel(0.0, 1e-5, 1))
    assert (found.least_step, found.by_rule) == (None, None)
    assert "least-step-open" in kinds(found)


def test_intervals_hold_the_value_where_moves_are_missing() -> None:
    there = np.r_[0:20, 45:109]
    steps = decaying_steps(STEPS_DEG[there] * DEG, overtravel(2e-5, 1e-5, 1)[there], 1e-7 * DEG)
    least = decaying_test(steps).least_step
    assert least is not None
    assert least.low <= least.value <= least.high


def test_no_least_step_names_the_steps_that_are_off() -> None:
    errors = overtravel(1e-6, 1e-5, 1)
    errors[[3, 4]] = -100.0
    (flag,) = [one for one in evaluated(errors).flags if one.kind == "least-step-open"]
    assert "moves 4, 5 are off by more than 50 %" in flag.text


@pytest.mark.parametrize(
    ("factor", "mistake"),
    [
        (2.0, "the stated spacing is half of the real one"),
        (0.5, "the stated spacing is twice the real one"),
        (25.4, "mm were taken for inches"),
        (180.0 / math.pi, "degrees were taken for radians"),
    ],
)
def test_steps_in_a_wrong_scale_name_the_mistake(factor: float, mistake: str) -> None:
    true = 1.0 + overtravel(1e-5, 1e-5, 3) / 100.0
    found = evaluated(100.0 * (factor * true - 1.0))
    assert found.least_step is None
    (text,) = [flag.text for flag in found.flags if flag.kind == "least-step-open"]
    assert mistake in text


def test_an_unknown_factor_names_no_mistake() -> None:
    found = evaluated(100.0 * (1.3 * (1.0 + overtravel(1e-5, 1e-5, 3) / 100.0) - 1.0))
    (text,) = [flag.text for flag in found.flags if flag.kind == "least-step-open"]
    assert "begin with larger steps, or check spacing and unit" in text


def test_scale_of_the_optics_widens_the_interval() -> None:
    steps = decaying_steps(COMMAND, overtravel(1e-4, 1e-6, 1))
    sure, unsure = decaying_test(steps).least_step, decaying_test(replace(steps, u_scale=0.03)).least_step
    assert sure is not None
    assert unsure is not None
    assert unsure.u > 3.0 * sure.u


def test_a_least_step_is_no_surer_than_its_cell() -> None:
    # Without scatter the series leaves a cell of it open: uniform, of width ln 1.072267 (GUM 4.3.7).
    least = decaying_test(decaying_steps(COMMAND, overtravel(1e-4, 1e-9, 1))).least_step
    assert least is not None
    assert least.u == pytest.approx(least.value * math.log(1.072267) / math.sqrt(12.0), rel=0.1)


def test_the_scatter_is_found_as_a_function_of_the_step() -> None:
    ratios = [
        scatter_percent(np.log(STEPS_DEG), overtravel(1e-4, 1e-4, seed), ALL) / (100.0 * 1e-4 / STEPS_DEG)
        for seed in range(40)
    ]
    assert np.mean(ratios, axis=0) == pytest.approx(1.0, abs=0.12)
    assert float(np.std(ratios, axis=0)[20:90].max()) < 0.2


def test_the_same_seed_gives_the_same_interval() -> None:
    steps = decaying_steps(COMMAND, overtravel(1e-4, 1e-4, 5))
    assert decaying_test(steps, seed=4).least_step == decaying_test(steps, seed=4).least_step


@pytest.mark.parametrize(
    ("command", "text"),
    [
        (COMMAND[::-1], "move 2 is .* no smaller than the one before"),
        (COMMAND * np.where(np.arange(109) == 60, -1.0, 1.0), "move 61 goes the other way"),
        (COMMAND[:10], "the test has 10 steps, and a moving mean takes 11: measure more"),
    ],
)
def test_other_series_are_refused(command: Floats, text: str) -> None:
    with pytest.raises(MovesError, match=text):
        decaying_test(decaying_steps(command, np.zeros(command.size)))


def test_steps_below_the_instruments_reach_are_refused() -> None:
    with pytest.raises(MovesError, match=r"of 109 steps lie above .* takes 11: begin with larger steps"):
        evaluated(overtravel(1e-4, 1e-7, 1), u_step_deg=1.0)


def test_sizes_that_a_controller_rounds_may_repeat() -> None:
    multiples = np.r_[100, 93, 87, 81, 76, 71, 66, 61, 57, 53, 50, 46, 43, np.arange(40.0, 0.0, -1.0)]
    # Added to positions between its multiples, two steps of it may become one size, by a last digit apart.
    rounded = np.where(multiples == 5.0, 4.5 + 1e-12, np.where(multiples == 4.0, 4.5 + 3e-12, multiples))
    least = decaying_test(decaying_steps(1e-3 * DEG * rounded, np.full(rounded.size, 1.0))).least_step
    assert least is not None
    assert least.value == pytest.approx(1e-3 * DEG)


def test_steps_of_one_size_are_no_decreasing_ones() -> None:
    with pytest.raises(MovesError, match=r"move 2 is .* no smaller than the one before"):
        decaying_test(decaying_steps(np.full(30, 0.1 * DEG), np.zeros(30)))


def test_a_threshold_has_to_be_positive() -> None:
    with pytest.raises(ArgumentError, match="threshold_percent"):
        evaluated(overtravel(1e-4, 1e-4, 1), 0.0)
