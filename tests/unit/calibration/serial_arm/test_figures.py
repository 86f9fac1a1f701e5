"""The figures of six-axis calibration in short; `make campaign-six-axis` has the long form."""

import numpy as np
import pytest

from catseye.calibration.core.least_squares import NormalEquations
from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.identification import identify_arm
from tests.unit.calibration.serial_arm.nominal import irb120, measured, validation
from tests.unit.calibration.serial_arm.studies import (
    accuracy,
    chosen_poses,
    disturbed,
    drifts,
    lacks_of_fit,
    plants,
)
from tests.unit.calibration.serial_arm.true_arm import random_poses


def test_noise_free_arm_is_exact_in_five_steps(monkeypatch: pytest.MonkeyPatch) -> None:
    steps: list[float] = []
    step = NormalEquations.step

    def counted(equations: NormalEquations, damping: float) -> Floats | None:
        steps.append(damping)
        return step(equations, damping)

    monkeypatch.setattr(NormalEquations, "step", counted)
    found = identify_arm(irb120(), measured(random_poses(38, 1)), "geometric+compliance")
    poses, places = validation(1000)
    missed = np.linalg.norm(found.places_mm(Commands.of(irb120(), poses), 0) - places, axis=1)
    assert missed.max() < 1e-8
    assert len(steps) <= 5


def test_chosen_poses_do_better_than_random_ones() -> None:
    chosen = accuracy(chosen_poses(1500, 1), 8)
    assert chosen.mean_mm.mean() <= 0.030
    assert chosen.max_mm.mean() <= 0.075
    assert accuracy(None, 8).mean_mm.mean() > chosen.mean_mm.mean()


def test_missing_compliance_shows_as_lack_of_fit() -> None:
    choice = chosen_poses(500, 1)
    assert lacks_of_fit(choice, 10, "geometric") == 1.0
    assert lacks_of_fit(choice, 10, "geometric+compliance") <= 0.1


def test_disturbed_set_costs_little_and_wrong_poses_are_named() -> None:
    found = disturbed(1)
    assert found.wrong == (3, 3)
    assert found.good[1] <= 1
    assert found.disturbed_mm[0] <= 1.5 * found.clean_mm[0]


def test_model_of_each_kind_of_plant_is_found() -> None:
    assert all(one.taken == one.right or one.ratio <= 1.02 for one in plants(3))


def test_model_that_lacks_something_shows_no_drift() -> None:
    assert drifts(25, "geometric") <= 2


def test_base_that_moves_is_seen_to_move() -> None:
    assert drifts(10, "geometric+compliance", size_mm=0.2) >= 9
