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
    MountingInRadians,
    MountingOff,
    RowsShifted,
    ZeroLost,
)
from catseye.calibration.scara.plausibility.judgement import judge
from catseye.calibration.scara.plausibility.mounting import mounting_mistake
from catseye.calibration.scara.points import Points
from tests.unit.calibration.scara.diagnostics.bench import commands_on_nodes, problem
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


@pytest.mark.parametrize("seed", range(4))
def test_a_mounting_in_radians_is_named(seed: int) -> None:
    points = measured(seed)
    assert points.mount_rad is not None
    wrong = asked(replace(points, mount_rad=np.radians(points.mount_rad)))
    assert judge(wrong, wrong.solve()).mistakes == (MountingInRadians("P1", 1, 1056, HALF_TURN + 0.02),)


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.parametrize("off_deg", [-10.0, 10.0, 40.0, -90.0])
def test_a_mounting_that_is_off_is_named(seed: int, off_deg: float) -> None:
    points = measured(seed)
    assert points.mount_rad is not None
    stated = np.where(points.mount_rad > 0.0, points.mount_rad + np.radians(off_deg), 0.0)
    wrong = asked(replace(points, mount_rad=stated))
    (mistake,) = judge(wrong, wrong.solve()).mistakes
    assert isinstance(mistake, MountingOff)
    assert (mistake.reflector, mistake.segment, mistake.row) == ("P1", 1, 1056)
    assert mistake.found_rad == pytest.approx(HALF_TURN + 0.02, abs=np.radians(7.0))


def accused(seeds: range) -> dict[int, object]:
    """Return which sound tables are accused of stating a wrong mounting, or none."""
    tables = {seed: coarse_table(seed) for seed in seeds}
    found = {seed: mounting_mistake(sound, sound.solve()) for seed, sound in tables.items()}
    return {seed: mistake for seed, mistake in found.items() if mistake is not None}


def coarse_table(seed: int) -> Problem:
    """Return a sound table of every other node: J4 moves by any amount, the turn is stated or has not happened."""
    rng = np.random.default_rng([1, seed])
    odd_mm, even_mm = 10.0 ** rng.uniform(-3.0, -1.5, 2)
    motion = AxisMotion.drawn(rng, odd_mm, even_mm)
    turn = rng.choice([0.0, HALF_TURN + rng.normal(0.0, 0.03)])
    commands = [one for one in commands_on_nodes() if (one[0] + 140.0) % 40.0 == one[1] % 40.0 == 0.0]
    points = mounted(random_truth(seed), motion.longer, [0.0, turn], 0.01, seed, commands)
    # Every other bench has warmed up meanwhile.
    warmer = points.displacement_mm * np.where(points.dead_path > 2, 1.0 + 3e-5 * (seed % 2), 1.0)
    sound = asked(replace(points, displacement_mm=warmer))
    return replace(sound, nodes1_rad=sound.nodes1_rad[::2], nodes2_rad=sound.nodes2_rad[::2])


def test_sound_mountings_are_not_accused() -> None:
    assert accused(range(12)) == {}


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
