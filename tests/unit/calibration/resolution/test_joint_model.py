"""Gaussian processes of joints whose mean and scatter are known."""

import numpy as np
import pytest

from catseye.calibration.core.errors import ArgumentError, InsufficientPointsError
from catseye.calibration.core.types import Floats
from catseye.calibration.resolution.joint_model import JointModel, table_of
from catseye.calibration.resolution.measured_steps import MeasuredSteps
from tests.unit.calibration.resolution.invented_arm import (
    SERIES_DEG,
    mean_percent,
    scatter_percent,
    step_errors,
)

JUDGED = np.geomspace(2e-4, 0.08, 12)


def measured(joint: int, positions: tuple[float, ...], seed: int) -> MeasuredSteps:
    rng = np.random.default_rng(seed)
    errors = np.concatenate([step_errors(joint, at, SERIES_DEG, rng) for at in positions])
    return MeasuredSteps(
        "A3", 1, np.repeat(positions, SERIES_DEG.size), np.tile(SERIES_DEG, len(positions)), errors
    )


def truth(joint: int, position: float, steps: Floats) -> tuple[Floats, Floats]:
    means = [mean_percent(joint, position, float(step)) for step in steps]
    return np.array(means), np.array([scatter_percent(joint, float(step)) for step in steps])


@pytest.fixture(scope="module")
def one_position() -> list[JointModel]:
    return [JointModel(measured(2, (0.0,), seed)) for seed in range(30)]


def test_uncertainty_of_the_mean_holds_at_one_position(one_position: list[JointModel]) -> None:
    mean, _ = truth(2, 0.0, JUDGED)
    found = [model.at(np.zeros(12), JUDGED) for model in one_position]
    inside = np.mean([np.abs(one.mean_percent - mean) < 2.0 * one.u_mean_percent for one in found])
    assert 0.88 < inside < 0.995


def test_noise_grows_with_the_spread_of_small_steps(one_position: list[JointModel]) -> None:
    _, scatter = truth(2, 0.0, JUDGED)
    ratios = [model.at(np.zeros(12), JUDGED).scatter_percent / scatter for model in one_position]
    middle = np.median(ratios, axis=0)
    assert scatter[0] / scatter[-1] > 40.0
    assert (np.abs(np.log(middle)) < np.log(1.35)).all()


def test_what_differs_between_sectors_is_followed() -> None:
    model = JointModel(measured(2, (-90.0, -45.0, 0.0, 45.0, 90.0), 1))
    steps = np.array([6e-4, 1e-3])
    for position in (-45.0, 45.0):
        mean, _ = truth(2, position, steps)
        found = model.at(np.full(2, position), steps)
        assert (np.abs(found.mean_percent - mean) < 3.0 * found.u_mean_percent).all()


def test_uncertainty_grows_between_sectors_that_differ() -> None:
    rng = np.random.default_rng(2)
    levels = {-90.0: 20.0, -45.0: -30.0, 0.0: 25.0, 45.0: -20.0, 90.0: 30.0}
    positions, commands = np.repeat(list(levels), 40), np.tile(np.geomspace(1e-3, 0.1, 40), 5)
    errors = np.array([levels[at] for at in positions]) + rng.normal(0.0, 2.0, positions.size)
    model = JointModel(MeasuredSteps("A3", 1, positions, commands, errors))
    at, between = (model.at(np.array([place]), np.array([0.01])) for place in (0.0, 22.5))
    assert at.u_mean_percent[0] < 3.0
    assert between.u_mean_percent[0] > 8.0


def test_a_table_keeps_to_what_was_measured() -> None:
    steps = measured(2, (0.0, 45.0), 3)
    table = table_of(JointModel(steps), {0.0: 0.004, 45.0: 0.006})
    assert [sector.position for sector in table.sectors] == [0.0, 11.25, 22.5, 33.75, 45.0]
    assert [sector.reversal for sector in table.sectors] == pytest.approx(
        [0.004, 0.0045, 0.005, 0.0055, 0.006]
    )
    for sector in table.sectors:
        assert sector.commands[[0, -1]] == pytest.approx([SERIES_DEG[-1], SERIES_DEG[0]])


def test_reversal_is_known_between_its_own_tests_only() -> None:
    table = table_of(JointModel(measured(2, (0.0, 45.0), 3)), {22.5: 0.004})
    assert [sector.reversal for sector in table.sectors] == [None, None, 0.004, None, None]


def test_steps_without_scatter_are_no_fault() -> None:
    commands = np.geomspace(1e-4, 0.1, 40)
    model = JointModel(MeasuredSteps("A1", -1, np.zeros(40), commands, np.full(40, -3.0)))
    found = model.at(np.zeros(1), np.array([0.01]))
    assert found.mean_percent[0] == pytest.approx(-3.0, abs=0.05)
    assert found.scatter_percent[0] < 0.05


def test_too_few_steps_are_refused() -> None:
    few = np.geomspace(1e-3, 0.1, 19)
    with pytest.raises(InsufficientPointsError, match="19 steps with an error, 20 are needed"):
        JointModel(MeasuredSteps("A1", 1, np.zeros(19), few, np.zeros(19)))


def test_commands_without_a_size_are_refused() -> None:
    with pytest.raises(ArgumentError, match="commands of A1"):
        MeasuredSteps("A1", 1, np.zeros(2), np.array([0.1, -0.1]), np.zeros(2))
