"""Least steps and lost motion of emulated drivetrains, stated from one test each time, against what many tests give.

The drivetrains hold no table of step errors; a seed draws all joints of an arm, and what scatters in their tests.
`CATSEYE_RESOLUTION_SEEDS` sets how many arms [50], `CATSEYE_RESOLUTION_FIRST` the first seed [0].
"""

import math
import os
from dataclasses import dataclass

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.backlash import backlash
from catseye.calibration.resolution.decaying import decaying_test
from catseye.calibration.resolution.least_step import moving_mean, steps_within
from catseye.simulators.world.serial.truth import draw_joint_truth
from tests.unit.calibration.resolution.measured import decaying_steps, measured_steps
from tests.unit.calibration.resolution.staircase import DEG
from tests.unit.simulators.world.serial.arms import TOOL, serial_arm
from tests.unit.simulators.world.serial.trials import POSITIONS_DEG, STEPS_DEG, Trials

FIRST = int(os.environ.get("CATSEYE_RESOLUTION_FIRST", "0"))
SEEDS = range(FIRST, FIRST + int(os.environ.get("CATSEYE_RESOLUTION_SEEDS", "50")))
REPEATS = 300
"""Trials beside those that are evaluated."""

TESTED = 20
"""Trials of each joint that are evaluated; 4 of each of 300 joints would show a coverage to no better than 0.7 %."""

U_STEP_DEG = 2e-6
"""Noise of a step by the interferometer: 0.035 µrad."""

TORQUE_NOISE_NM = 0.5
"""Of one torque that a controller shows: a hundredth of the friction of a large motor."""

STEP_DEG = 0.1
MOVES_DEG = STEP_DEG * np.tile(np.repeat([1.0, -1.0], 10), 5)
ARM = serial_arm("kr210-r2700", TOOL)
NAMES = [joint.name for joint in ARM.joints]


@dataclass(frozen=True)
class Stated:
    """One stated least step against that of the mean of many tests.

    Attributes:
        steps_off: stated minus true in steps of the series, positive where it is too small.
        held: the interval holds the true one.
    """

    steps_off: float
    held: bool


def trials(seed: int, joint: int, count: int = 1) -> Trials:
    """Return trials of a joint that share no random number with those of any other joint or arm."""
    truth = draw_joint_truth(ARM, seed).joints[joint]
    position_deg = POSITIONS_DEG[NAMES[joint]][seed % 5]
    return Trials(ARM, truth, joint, position_deg, count, 1000 + len(NAMES) * seed + joint)


def stated(seed: int, joint: int) -> list[Stated]:
    """Test a joint some times, with noise of the instrument, and as often as the truth takes, without."""
    errors = trials(seed, joint, REPEATS + TESTED).decaying(1 if seed % 2 else -1)
    own, mean = errors[:, :TESTED], errors[:, TESTED:].mean(axis=1)
    true_deg = STEPS_DEG[int(steps_within(moving_mean(mean), 10.0)) - 1]
    noise = np.random.default_rng([seed, joint]).normal(0.0, U_STEP_DEG, own.shape)
    return [one_stated(test, float(true_deg), seed) for test in (own + 100.0 * noise / STEPS_DEG[:, None]).T]


def one_stated(errors_percent: Floats, true_deg: float, seed: int) -> Stated:
    """Evaluate one test of a joint whose least step is known."""
    steps = decaying_steps(STEPS_DEG * DEG, errors_percent, U_STEP_DEG * DEG)
    least = decaying_test(steps, seed=seed).least_step
    assert least is not None
    ratio = math.log(true_deg * DEG / least.value) / math.log(1.072267)
    return Stated(ratio, least.low <= true_deg * DEG <= least.high)


@dataclass(frozen=True)
class Reversed:
    """A stated reversal error against that of many tests.

    Attributes:
        z: its error over its standard uncertainty.
        valid: it is called lost motion.
        changes: the torque changes its sign between the directions, by the mean of all trials.
    """

    z: float
    valid: bool | None
    changes: bool


def forth_and_back(joint: Trials) -> tuple[Floats, Floats]:
    """Move all trials as the test does.

    Returns:
        Where they stand before and after the 100 moves, deg, shape (101, count), and torques behind each move, N m.
    """
    start = joint.drive.link_deg - 5.0 * STEP_DEG
    places, torques = [joint.go(start)], []
    for target in start + np.cumsum(MOVES_DEG)[:, None]:
        places.append(joint.go(target))
        torques.append(joint.torque_nm)
    return np.array(places), np.array(torques)


def lost_deg(places: Floats) -> float:
    """Return the mean over nine positions, five cycles and all trials of backwards minus forwards, deg."""
    cycles = places[1:].reshape(5, 2, 10, -1)
    return float(np.mean(cycles[:, 1, 8::-1] - cycles[:, 0, :9]))


def reversed_once(seed: int, joint: int) -> Reversed:
    """Test a joint once, as an interferometer and a controller see it, and as often as the truth takes."""
    places, torques = forth_and_back(trials(seed, joint, REPEATS + 1))
    rng = np.random.default_rng([seed, joint])
    seen = places[:, 0] + rng.normal(0.0, U_STEP_DEG / math.sqrt(2.0), places.shape[0])
    steps = measured_steps(MOVES_DEG * DEG, seen * DEG, U_STEP_DEG * DEG)
    shown_nm = torques[:, 0] + rng.normal(0.0, TORQUE_NOISE_NM, torques.shape[0])
    one = backlash(steps, steps.moves.time_s + 1.0, shown_nm)
    forward_nm, backward_nm = torques.reshape(5, 2, 10, -1)[:, :, :9].mean(axis=(0, 2, 3))
    z = (one.lost_motion / DEG - lost_deg(places[:, 1:])) / (one.u / DEG)
    return Reversed(z, one.valid, bool(forward_nm * backward_nm < 0.0))


@pytest.mark.slow
def test_least_steps_are_stated_without_bias_and_their_intervals_hold() -> None:
    found = [one for seed in SEEDS for joint in range(len(NAMES)) for one in stated(seed, joint)]
    bias = float(np.median([one.steps_off for one in found]))
    held = float(np.mean([one.held for one in found]))
    print(  # noqa: T201  # the figure
        f"\n{len(found)} least steps of {len(SEEDS)} arms: median bias {bias:+.1f} steps of the series, "
        f"{100.0 * held:.1f} % within 95 % intervals"
    )
    assert abs(bias) <= 1.0
    assert 0.93 <= held <= 0.97


@pytest.mark.slow
def test_lost_motion_is_within_u_and_valid_for_play() -> None:
    found = [reversed_once(seed, joint) for seed in SEEDS for joint in range(len(NAMES))]
    rms = float(np.sqrt(np.mean([one.z**2 for one in found])))
    changing, unchanged = (
        [one.valid is True for one in found if one.changes is kind] for kind in (True, False)
    )
    print(  # noqa: T201  # the figure
        f"\n{len(found)} reversal errors: z = {rms:.2f} rms; {sum(changing)} of {len(changing)} are valid where the "
        f"torque changes its sign, {sum(unchanged)} of {len(unchanged)} where it does not"
    )
    assert 0.9 <= rms <= 1.1
    assert not any(unchanged)
