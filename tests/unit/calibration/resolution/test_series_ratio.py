"""Series that fall by another ratio than the moves, against joints whose errors are written down or emulated."""

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.errors import MovesError
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


@pytest.mark.parametrize("first_deg", [0.1, 0.09])
@pytest.mark.parametrize("ratio", [1.03, 1.05, 1.06, 1.09, 1.1])
def test_another_ratio_is_refused_and_named(ratio: float, first_deg: float) -> None:
    done = first_deg / ratio**NUMBERS + 1e-4
    with pytest.raises(
        MovesError, match=r"those commanded by 1\.072: these are moves of another run"
    ) as refused:
        ratio_flags(decaying_steps(STEPS_DEG * DEG, errors_of(done)))
    named = float(str(refused.value).split("fall by ")[1].split(" ")[0])
    assert named == pytest.approx(ratio, abs=0.001)


def test_a_ratio_that_is_nearly_right_is_flagged() -> None:
    (flag,) = ratio_flags(decaying_steps(STEPS_DEG * DEG, errors_of(0.1 / 1.069**NUMBERS)))
    assert flag.kind == "scale"
    assert "these may be moves of another run" in flag.text


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
