"""What the drivetrains of a KR 210 do, against what the resolution paper reports (sections 3.3, 4.1, 4.2)."""

from functools import cache

import numpy as np
import pytest

from catseye.simulators.world.serial.truth import draw_joint_truth
from catseye.simulators.world.types import Floats
from tests.unit.simulators.world.serial.arms import TOOL, serial_arm
from tests.unit.simulators.world.serial.trials import POSITIONS_DEG, STEPS_DEG, Trials, least_step_deg

ARM = serial_arm("kr210-r2700", TOOL)
NAMES = [joint.name for joint in ARM.joints]
TRUTHS = draw_joint_truth(ARM, 3).joints
K3 = 2


def trials(name: str, position: int, count: int = 1) -> Trials:
    joint = NAMES.index(name)
    return Trials(ARM, TRUTHS[joint], joint, POSITIONS_DEG[name][position], count)


@cache
def errors(name: str, direction: int) -> Floats:
    return trials(name, K3, count=200).decaying(direction)


@cache
def reversal(name: str, position: int) -> tuple[float, bool]:
    """Return the lost motion over nine interior places, and whether the torque changes its sign."""
    places, torques = trials(name, position).there_and_back(0.1)
    forth, back = places[:, 0, :9].mean(axis=0), places[:, 1, 8::-1].mean(axis=0)
    lost_deg = float(np.mean(back - forth))
    return lost_deg, bool(torques[:, 0].mean() * torques[:, 1].mean() < 0.0)


@pytest.mark.parametrize("direction", [1, -1])
@pytest.mark.parametrize("name", NAMES)
def test_least_steps_lie_in_the_published_ranges(name: str, direction: int) -> None:
    low, high = (1e-4, 1e-3) if name in {"A1", "A2", "A3"} else (2e-3, 6e-3)
    assert low <= least_step_deg(errors(name, direction).mean(axis=1)) <= high


@pytest.mark.parametrize("name", NAMES)
def test_step_errors_scatter_more_the_smaller_the_step(name: str) -> None:
    scatter = errors(name, 1).std(axis=1)
    decades = [scatter[k : k + 10].mean() for k in (0, 33, 66, 99)]
    assert decades == sorted(decades)
    assert decades[-1] > 10.0 * decades[0]


@pytest.mark.parametrize("name", ["A1", "A3", "A4", "A5", "A6"])
def test_larger_steps_go_slightly_too_far(name: str) -> None:
    larger = errors(name, 1)[STEPS_DEG > 5e-3].mean()
    assert 0.0 < larger < 5.0


def test_the_balanced_joint_scatters_most_of_the_main_axes() -> None:
    small = STEPS_DEG < 1e-3
    scatter = {name: float(errors(name, 1)[small].std(axis=1).mean()) for name in ("A1", "A2", "A3")}
    assert max(scatter, key=scatter.__getitem__) == "A2"


@pytest.mark.parametrize("position", range(5))
@pytest.mark.parametrize("name", NAMES)
def test_reversal_errors_are_of_the_published_size(name: str, position: int) -> None:
    lost_deg, _ = reversal(name, position)
    assert 0.0015 < lost_deg < 0.014


@pytest.mark.parametrize(
    ("name", "changing"),
    [("A1", {0, 1, 2, 3, 4}), ("A3", set()), ("A4", {0, 2, 4}), ("A5", {0, 4})],
)
def test_torque_changes_its_sign_where_load_is_small(name: str, changing: set[int]) -> None:
    assert {position for position in range(5) if reversal(name, position)[1]} == changing


@pytest.mark.parametrize("name", ["A4", "A5"])
def test_play_shows_only_where_the_torque_changes_its_sign(name: str) -> None:
    (crossed_deg, _), (loaded_deg, _) = reversal(name, 0), reversal(name, 1)
    assert crossed_deg > 2.5 * loaded_deg


def test_steps_are_flattened_after_a_reversal() -> None:
    step_deg = 2e-3
    places, _ = trials("A1", K3).there_and_back(step_deg, cycles=2)
    back_deg = -np.diff(places[1, 1])
    assert np.all(back_deg[:2] < 0.7 * step_deg)
    assert back_deg[-3:].mean() == pytest.approx(step_deg, rel=0.05)


def moved_deg(*, relative: bool) -> Floats:
    """Return 200 steps of A5 by its least step, after its run-in."""
    joint = trials("A5", K3)
    joint.run_in(1)
    size = 4e-3
    start = joint.drive.link_deg
    if relative:
        return np.array([joint.step(size)[0] for _ in range(200)])
    return np.diff([joint.go(start + size * (k + 1))[0] for k in range(201)])


def test_absolute_steps_alternate_and_relative_steps_do_not() -> None:
    for relative, expected in ((False, -0.5), (True, 0.0)):
        deviations = moved_deg(relative=relative)
        correlation = np.corrcoef(deviations[1:-1], deviations[2:])[0, 1]
        assert correlation == pytest.approx(expected, abs=0.17)


def test_absolute_steps_go_the_commanded_way_on_the_whole() -> None:
    assert moved_deg(relative=False).mean() == pytest.approx(4e-3, rel=0.01)
    assert moved_deg(relative=True).mean() > 1.05 * 4e-3
