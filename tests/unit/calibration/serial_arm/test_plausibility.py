"""Mistakes in tables of poses are named."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.serial_arm.geometry import Commands
from catseye.calibration.serial_arm.measurements import Measurements
from catseye.calibration.serial_arm.plausibility import ImplausibleError, require_plausible
from tests.unit.calibration.serial_arm.nominal import irb120, measured
from tests.unit.calibration.serial_arm.true_arm import random_poses

Change = Callable[[Measurements], Measurements]


def joints(change: Callable[[Floats], Floats]) -> Change:
    return lambda rows: replace(rows, commands=Commands.of(irb120(), change(rows.commands.joints)))


def places(change: Callable[[Floats], Floats]) -> Change:
    return lambda rows: replace(rows, points=replace(rows.points, place_mm=change(rows.points.place_mm)))


def renamed(rows: Measurements) -> Measurements:
    to = np.array([0, 2, 1])
    return replace(rows, points=replace(rows.points, target=to[rows.points.target]))


@pytest.mark.parametrize(
    ("change", "named"),
    [
        (joints(np.deg2rad), "in rad, not in deg"),
        (joints(lambda q: q[:, ::-1]), "opposite order"),
        (joints(lambda q: q[:, [1, 0, 2, 3, 4, 5]]), "J1 and J2 are exchanged"),
        (joints(lambda q: q * np.array([1.0, 1.0, -1.0, 1.0, 1.0, 1.0])), "J3 has the opposite sign"),
        (joints(lambda q: np.roll(q, -1, axis=0)), "rows are one pose late"),
        (places(lambda x: x / 1000.0), "in m, not in mm"),
        (joints(lambda q: np.where(np.arange(6) == 2, np.deg2rad(q), q)), "J3 is in rad, not in deg"),
        (
            places(lambda x: np.where(np.arange(len(x))[:, None] % 7 == 3, x / 1000.0, x)),
            r"the places of \d+ rows are in m, not in mm \(the first: pose",
        ),
        (places(lambda x: x / 25.4), "in inches, not in mm"),
        (places(lambda x: x * np.array([1.0, -1.0, 1.0])), "left-handed"),
        (renamed, "nest2 is nest3"),
        (
            joints(lambda q: np.where(np.arange(len(q))[:, None] % 2, np.deg2rad(q), q)),
            r"the joints of 20 poses are in rad, not in deg \(the first: pose",
        ),
        (
            lambda rows: places(lambda x: x / 1000.0)(joints(np.deg2rad)(rows)),
            "the joints are in rad and the coordinates in m",
        ),
        (joints(lambda q: q + 90.0 * (np.arange(6) == 1)), "J2 counts from a zero -90 deg away"),
        (places(lambda x: np.where(np.arange(len(x))[:, None] == 7, 0.0, x)), "if 'pose 8' is left out"),
        (joints(lambda q: 0.0 * q + q[0]), "all 40 poses have the same joints"),
    ],
)
def test_mistake_is_named(change: Change, named: str) -> None:
    with pytest.raises(ImplausibleError, match=named):
        require_plausible(irb120(), change(measured(random_poses(40, 1), 1)))


def test_poses_of_another_arm_are_refused() -> None:
    with pytest.raises(ImplausibleError, match="another arm, joints at other poses"):
        require_plausible(
            irb120(), joints(lambda q: random_poses(len(q), 2))(measured(random_poses(40, 1), 1))
        )


@pytest.mark.parametrize("seed", range(10))
def test_sound_measurements_pass(seed: int) -> None:
    rows = measured(random_poses(40, seed), seed)
    require_plausible(irb120(), rows)
    assert len(rows.points.pose) == 40
