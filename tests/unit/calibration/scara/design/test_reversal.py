"""What a second mounting of the interferometer is worth, against the dense problem of both mountings."""

import math

import numpy as np
import pytest

from catseye.calibration.core.types import Floats
from catseye.calibration.scara.budget import Budget, Contributor
from catseye.calibration.scara.design.reversal import measured_twice, seen_twice
from tests.unit.calibration.scara.design.cases import RING, SIGMA_MM, SMALL, WHITE, seen_by_all, study
from tests.unit.calibration.scara.design.dense import LINKS

J4_MM = 0.05
BUDGET = Budget((*WHITE.contributors, Contributor("J4", "radial", J4_MM, "axis-angle", "j4", orders=2)))
PLACE = RING[4]


def motions(mount: float) -> Floats:
    """Return what unit motions of J4's axis do to beams: cosine and sine of two orders in x and in y of link 2."""
    rows = []
    for i1, i2, _, _ in SMALL.rows():
        a, b = math.radians(SMALL.nodes1_deg[i1]), math.radians(SMALL.nodes2_deg[i2])
        x = LINKS[0] * math.cos(a) + LINKS[1] * math.cos(a + b)
        y = LINKS[0] * math.sin(a) + LINKS[1] * math.sin(a + b)
        beam = math.atan2(PLACE[1] - y, PLACE[0] - x) - a - b
        waves = [wave(order * (beam - mount)) for order in (1, 2) for wave in (math.cos, math.sin)]
        rows.append([-along(beam) * one for along in (math.cos, math.sin) for one in waves])
    return np.array(rows) * J4_MM / math.sqrt(2.0)


def dense_covariance(mounts: tuple[float, float]) -> Floats:
    """Return the arm's covariance from one reflector measured twice: its place once, a dead path each time."""
    block = SMALL.block(PLACE)
    both = np.zeros((2 * len(block), block.shape[1] + 1))
    both[:, :-2] = np.tile(block[:, :-1], (2, 1))
    both[: len(block), -2] = both[len(block) :, -1] = -1.0
    effects = np.vstack([motions(mount) for mount in mounts])
    inverse = np.linalg.inv(SIGMA_MM**2 * np.eye(len(both)) + effects @ effects.T)
    # The gauge as a distance that is known exactly: the mean of the J1 map.
    gauge = np.zeros(both.shape[1])
    gauge[2 : 2 + 2 * len(SMALL.nodes1_deg)] = 1.0
    scale = np.sqrt(np.diag(both.T @ inverse @ both))
    bordered = np.block(
        [
            [(both.T @ inverse @ both) / np.outer(scale, scale), (gauge / scale)[:, None]],
            [gauge / scale, np.zeros(1)],
        ]
    )
    found = np.linalg.inv(bordered)[:-1, :-1] / np.outer(scale, scale)
    return np.asarray(found[: SMALL.arm_size, : SMALL.arm_size])


@pytest.mark.parametrize("turned", [False, True])
def test_covariance_is_that_of_the_dense_problem(turned: bool) -> None:
    twice = measured_twice(study(SMALL, BUDGET), turned=turned)
    sight = seen_twice(seen_by_all(PLACE, len(twice.commands) // 2))
    mine = twice.arm(twice.covariance(twice.rows(sight).information(), systematic=True)).covariance
    dense = dense_covariance((0.0, math.pi if turned else 0.0))
    scale = np.sqrt(np.diag(dense))
    assert np.abs((mine - dense) / np.outer(scale, scale)).max() < 1e-5


def test_a_second_pass_has_dead_paths_of_its_own() -> None:
    once = seen_by_all(PLACE, 4)
    assert seen_twice(once).segment.tolist() == [0] * 4 + [1] * 4
    assert seen_twice(once).segments == 2
