"""Series that fall by another ratio than the moves, against joints whose errors are written down or emulated."""

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import MovesError
from catseye.calibration.resolution.flags import Flag, doubts
from catseye.calibration.resolution.series_ratio import ratio_flags
from catseye.simulators.world.serial.truth import draw_joint_truth
from tests.unit.calibration.resolution.measured import decaying_steps
from tests.unit.calibration.resolution.staircase import DEG, STEPS_DEG
from tests.unit.simulators.world.serial.arms import TOOL, serial_arm
from tests.unit.simulators.world.serial.trials import Trials

NUMBERS = np.arange(109.0)


def errors_of(done_deg: Floats, scatter: float = 0.002, seed: int = 1) -> Floats:
    """Return the errors, %, of steps that were made, with a scatter as a share of each."""
    made = done_deg * (1.0 + np.random.default_rng(seed).normal(0.0, scatter, done_deg.size))
    return np.asarray(100.0 * (made / STEPS_DEG - 1.0))


def doubts_of(done_deg: Floats, scatter: float) -> list[Flag]:
    """Return what five series of such steps make doubtful, each with a scatter of its own."""
    series = [decaying_steps(STEPS_DEG * DEG, errors_of(done_deg, scatter, seed)) for seed in range(5)]
    return [flag for one in series for flag in doubts(ratio_flags(one), range(1, 110))]


@pytest.mark.parametrize("first_deg", [0.1, 0.09])
@pytest.mark.parametrize("ratio", [1.03, 1.05, 1.06, 1.065, 1.09, 1.1, 1.12, 1.15])
def test_another_ratio_is_refused_and_named(ratio: float, first_deg: float) -> None:
    done = first_deg / ratio**NUMBERS + 1e-4
    with pytest.raises(
        MovesError, match=r"those commanded by 1\.072: these are moves of another run"
    ) as refused:
        ratio_flags(decaying_steps(STEPS_DEG * DEG, errors_of(done)))
    named = float(str(refused.value).split("fall by ")[1].split(" ")[0])
    assert named == pytest.approx(ratio, abs=0.001)


@pytest.mark.parametrize("ratio", [1.18, 1.2, 1.23])
def test_a_ratio_that_leaves_few_steps_is_refused(ratio: float) -> None:
    """Some 10 to 15 steps with a scatter of 1 % are left, which know the ratio to a hundredth."""
    done = 0.1 / ratio**NUMBERS
    with pytest.raises(MovesError, match="these are moves of another run") as refused:
        ratio_flags(decaying_steps(STEPS_DEG * DEG, errors_of(done, 0.01)))
    named = float(str(refused.value).split("fall by ")[1].split(" ")[0])
    assert named == pytest.approx(ratio, abs=0.01)


@pytest.mark.parametrize(("ratio", "doubted"), [(1.069, False), (1.075, False), (1.067, True), (1.078, True)])
def test_a_ratio_that_is_nearly_right_is_flagged(ratio: float, doubted: bool) -> None:
    flags = ratio_flags(decaying_steps(STEPS_DEG * DEG, errors_of(0.1 / ratio**NUMBERS)))
    (flag,) = flags
    assert "are they moves of another run" in flag.text
    assert bool(doubts(flags, ())) is doubted


@pytest.mark.parametrize("scatter", [0.002, 0.01])
@pytest.mark.parametrize("percent", [1.0, 3.0])
def test_errors_linear_in_the_logarithm_speak_against_nothing(percent: float, scatter: float) -> None:
    done = STEPS_DEG * (1.0 - percent / 100.0 * np.log(0.1 / STEPS_DEG))
    assert doubts_of(done, scatter) == []


@pytest.mark.parametrize("scatter", [0.002, 0.01])
@pytest.mark.parametrize("percent", [3.0, 10.0])
def test_errors_by_contact_mechanics_speak_against_nothing(percent: float, scatter: float) -> None:
    """Elastic contacts give by the power 2/3 of a load."""
    done = STEPS_DEG - percent / 100.0 * 0.1 * (STEPS_DEG / 0.1) ** (2.0 / 3.0)
    assert doubts_of(done, scatter) == []


@pytest.mark.parametrize("least_deg", [0.001, 0.01, 0.02, 0.03, 0.05, 0.1])
def test_a_joint_that_stops_early_is_no_other_ratio(least_deg: float) -> None:
    """What a spring in front of the friction takes up is missing: nearly all of steps that are smaller than it."""
    done = STEPS_DEG**2 / (STEPS_DEG + least_deg)
    for seed in range(3):
        assert ratio_flags(decaying_steps(STEPS_DEG * DEG, errors_of(done, 0.01, seed))) == []


@pytest.mark.parametrize("least_deg", [0.0002, 0.002, 0.02])
@pytest.mark.parametrize("sense", [1.0, -1.0])
@pytest.mark.parametrize("power", [1.0, 2.0])
def test_errors_of_a_joint_are_no_other_ratio(least_deg: float, sense: float, power: float) -> None:
    done = STEPS_DEG * (1.0 + 0.1 * sense * (least_deg / STEPS_DEG) ** power)
    for seed in range(5):
        assert ratio_flags(decaying_steps(STEPS_DEG * DEG, errors_of(done, 0.01, seed))) == []


def test_a_scale_that_all_steps_share_is_no_other_ratio() -> None:
    assert ratio_flags(decaying_steps(STEPS_DEG * DEG, errors_of(0.8 * STEPS_DEG))) == []


@pytest.mark.parametrize("arm", ["kr210-r2700", "irb120"])
def test_emulated_joints_fall_as_commanded(arm: str) -> None:
    described = serial_arm(arm, TOOL)
    for number, truth in enumerate(draw_joint_truth(described, 31).joints):
        axis = described.joints[number]
        middle_deg = 0.5 * (axis.low + axis.high) + 10.0
        for errors in Trials(described, truth, number, middle_deg, 10, number).decaying(1).T:
            assert ratio_flags(decaying_steps(STEPS_DEG * DEG, errors)) == []


@pytest.mark.parametrize("arm", ["kr210-r2700", "irb120"])
def test_emulated_joints_that_fell_by_another_ratio_are_refused(arm: str) -> None:
    described = serial_arm(arm, TOOL)
    for number, truth in enumerate(draw_joint_truth(described, 32).joints):
        axis = described.joints[number]
        trials = Trials(described, truth, number, 0.5 * (axis.low + axis.high) + 10.0, 5, number)
        trials.run_in(1)
        done = np.array([trials.step(size) for size in 0.1 / 1.05**NUMBERS])
        for one in done.T:
            with pytest.raises(MovesError, match=r"fall by 1\.0[45]\d* from one to the next"):
                ratio_flags(decaying_steps(STEPS_DEG * DEG, 100.0 * (one / STEPS_DEG - 1.0)))


def test_moves_that_the_controller_confirmed_are_not_refused() -> None:
    done = STEPS_DEG * (STEPS_DEG / STEPS_DEG[0]) ** 0.2
    found = decaying_steps(STEPS_DEG * DEG, errors_of(done))
    with pytest.raises(MovesError):
        ratio_flags(found)
    (flag,) = ratio_flags(found, confirmed=True)
    assert "the controller confirmed the moves" in flag.text
