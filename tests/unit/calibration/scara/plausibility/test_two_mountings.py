"""The gate and tables of two mountings of the interferometer: sound ones pass, mistakes are named all the same."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from catseye.calibration.scara.diagnostics.problem import Problem
from catseye.calibration.scara.plausibility.corrections import shifted
from catseye.calibration.scara.plausibility.findings import (
    AngleSignReversed,
    DisplacementScaled,
    Mistake,
    MountingForgotten,
    RowsShifted,
    ZeroLost,
)
from catseye.calibration.scara.plausibility.judgement import judge
from catseye.calibration.scara.points import Points
from tests.unit.calibration.scara.diagnostics.bench import problem
from tests.unit.calibration.scara.paper import random_truth
from tests.unit.calibration.scara.plausibility.tables import table_2
from tests.unit.calibration.scara.reversal import HALF_TURN, AxisMotion, mounted

LOST_AT = 1056 + 352 + 171


def measured(seed: int) -> Points:
    motion = AxisMotion.drawn(np.random.default_rng(seed), 0.03, 0.01)
    return mounted(random_truth(seed), motion.longer, [0.0, HALF_TURN + 0.02], 0.01, seed)


def asked(points: Points) -> Problem:
    return replace(problem(points), budget=table_2())


@pytest.mark.parametrize("seed", range(4))
def test_sound_tables_pass(seed: int) -> None:
    sound = asked(measured(seed))
    assert not judge(sound, sound.solve()).implausible


@pytest.mark.parametrize("seed", range(4))
def test_a_forgotten_mounting_is_named(seed: int) -> None:
    forgotten = asked(replace(measured(seed), mount_rad=None))
    assert judge(forgotten, forgotten.solve()).mistakes == (MountingForgotten("P1", 1, 1056),)


@pytest.mark.parametrize("seed", range(3))
def test_a_second_pass_without_a_turn_is_none(seed: int) -> None:
    motion = AxisMotion.drawn(np.random.default_rng(seed), 0.03, 0.03)
    twice = mounted(random_truth(seed), motion.longer, [0.0, 0.0], 0.01, seed)
    # The arm warmed up meanwhile: both links by 60 ppm of the distance from J1, roughly.
    warmer = twice.displacement_mm * np.where(twice.dead_path > 2, 1.0 + 6e-5, 1.0)
    for points in (replace(twice, mount_rad=None), replace(twice, mount_rad=None, displacement_mm=warmer)):
        sound = asked(points)
        assert not judge(sound, sound.solve()).mistakes


def reversed_sign(points: Points) -> Points:
    commands = points.commands
    return replace(points, commands=replace(commands, theta2_rad=-commands.theta2_rad))


def in_metres(points: Points) -> Points:
    return replace(points, displacement_mm=1e-3 * points.displacement_mm)


def with_lost_zero(points: Points) -> Points:
    later = (np.arange(len(points)) >= LOST_AT) & (points.dead_path == points.dead_path[LOST_AT])
    return replace(points, displacement_mm=points.displacement_mm - 40.0 * later)


def one_row_up(points: Points) -> Points:
    return shifted(points, -1)


@pytest.mark.parametrize(
    ("spoiled", "kind"),
    [
        (reversed_sign, AngleSignReversed),
        (in_metres, DisplacementScaled),
        (one_row_up, RowsShifted),
        (with_lost_zero, ZeroLost),
    ],
)
def test_a_mistake_in_them_is_named(spoiled: Callable[[Points], Points], kind: type[Mistake]) -> None:
    found = judge(asked(spoiled(measured(9))), None)
    assert found.implausible
    assert kind in {type(mistake) for mistake in found.mistakes}
    (mistake,) = (one for one in found.mistakes if isinstance(one, kind))
    if isinstance(mistake, ZeroLost):
        assert (mistake.reflector, mistake.segment, mistake.row) == ("P2", 1, LOST_AT)
