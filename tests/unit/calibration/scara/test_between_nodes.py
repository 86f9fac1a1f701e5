"""What lies between nodes, against ripples drawn one by one."""

import math

import numpy as np
import pytest

from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.between_nodes import Places, ripple_between_nodes
from tests.unit.calibration.scara.paper import NODES1_DEG

NODES = np.deg2rad(NODES1_DEG)


def between_nodes(nodes: Floats, angle: Floats, direction: Ints) -> Floats:
    return Places.of(nodes, angle, direction).effects(angle, direction)


def ups(count: int) -> "np.ndarray[tuple[int, ...], np.dtype[np.int64]]":
    return np.ones(count, dtype=np.int64)


def left_by_a_line(order: int, phase: float, theta_deg: float) -> float:
    """Return what a ripple of rms 1 leaves of itself between the nodes next to an angle."""
    low = math.floor(theta_deg / 20.0) * 20.0
    share = (theta_deg - low) / 20.0
    wave = [
        math.sqrt(2.0) * math.sin(order * math.radians(angle) + phase)
        for angle in (theta_deg, low, low + 20.0)
    ]
    return wave[0] - (1.0 - share) * wave[1] - share * wave[2]


def drawn_variance(theta_deg: float) -> float:
    rng = np.random.default_rng(1)
    draws = [
        left_by_a_line(int(rng.integers(18, 145)), float(rng.uniform(0.0, 2.0 * math.pi)), theta_deg)
        for _ in range(4000)
    ]
    return float(np.mean(np.square(draws)))


def variances(effects: Floats) -> Floats:
    return np.asarray(np.sum(effects**2, axis=1))


def test_a_joint_does_nothing_more_at_its_nodes() -> None:
    effects = between_nodes(NODES, np.repeat(NODES, 2), np.tile([1, -1], NODES.size))
    assert not np.any(effects)


@pytest.mark.parametrize("theta_deg", [-135.0, -110.0, -36.0, 7.0, 44.0])
def test_its_variance_is_that_of_drawn_ripples(theta_deg: float) -> None:
    found = variances(between_nodes(NODES, np.array([math.radians(theta_deg)]), ups(1)))
    # Four thousand draws know a mean square to some percent.
    assert float(found[0]) == pytest.approx(drawn_variance(theta_deg), rel=0.1)


def test_its_size_alone_is_that_of_its_sources() -> None:
    theta = np.linspace(NODES[0], NODES[-1], 281)
    found = ripple_between_nodes(NODES, theta)
    assert found**2 == pytest.approx(variances(between_nodes(NODES, theta, ups(theta.size))), abs=1e-12)
    assert not np.any(ripple_between_nodes(NODES, NODES))


def test_half_way_the_nodes_add_half_a_variance() -> None:
    middles = 0.5 * (NODES[1:] + NODES[:-1])
    found = variances(between_nodes(NODES, middles, ups(middles.size)))
    assert float(found.mean()) == pytest.approx(1.5, rel=0.1)


def test_both_directions_err_on_their_own() -> None:
    angle = np.full(2, math.radians(33.0))
    effects = between_nodes(NODES, angle, np.array([1, -1]))
    assert float(effects[0] @ effects[1]) == pytest.approx(0.0, abs=1e-12)
    same = between_nodes(NODES, angle, np.array([1, 1]))
    assert same[0] == pytest.approx(same[1])


def test_neighbours_err_alike_and_distant_angles_do_not() -> None:
    effects = between_nodes(NODES, np.deg2rad([30.0, 30.2, -67.0]), ups(3))
    covariance = effects @ effects.T
    correlation = covariance / np.sqrt(np.outer(np.diag(covariance), np.diag(covariance)))
    assert correlation[0, 1] > 0.95
    assert abs(correlation[0, 2]) < 0.5


def test_few_commands_have_the_covariance_of_many() -> None:
    many = np.deg2rad(np.linspace(-139.0, 59.0, 300))
    chosen = np.arange(0, 300, 60)
    whole = between_nodes(NODES, many, ups(300))
    few = between_nodes(NODES, many[chosen], ups(chosen.size))
    assert few.shape[1] <= chosen.size < whole.shape[1]
    np.testing.assert_allclose(few @ few.T, whole[chosen] @ whole[chosen].T, atol=1e-12)


def test_a_model_without_maps_has_nothing_between_nodes() -> None:
    assert between_nodes(np.zeros(0), NODES, ups(NODES.size)).shape == (NODES.size, 0)
