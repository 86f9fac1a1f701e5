"""Commands between the nodes: where they are, and on the way of which joint."""

import cmath
import math
from itertools import pairwise

import numpy as np
import pytest

from catseye.calibration.scara.design.off_node import off_node_angles
from catseye.procedures.scara.motion.approach import bidirectional_sequence, with_take_up
from catseye.procedures.scara.open_loop.off_node import measuring_sequence, usual_count
from catseye.procedures.scara.open_loop.open_loop import OpenLoop, OpenLoopParams
from tests.unit.procedures.benches import NODES1_DEG, NODES2_DEG, bench
from tests.unit.procedures.test_approach import assert_on_the_claimed_flanks


def coherence(angles_deg: list[float], order: int) -> float:
    """Return how far the phases of an order at the angles agree: 1 where they are all the same."""
    return abs(sum(cmath.exp(1j * order * math.radians(angle)) for angle in angles_deg)) / len(angles_deg)


@pytest.mark.parametrize("nodes", [NODES1_DEG, NODES2_DEG])
@pytest.mark.parametrize("count", [12, 20, 24])
def test_no_order_has_the_same_phase_at_all_angles(nodes: tuple[float, ...], count: int) -> None:
    angles = off_node_angles(np.array(nodes), count).tolist()
    assert len(set(angles)) == count
    # Angles drawn at random have a worst order of 0.7 with 12 and of 0.6 with 20.
    assert max(coherence(angles, order) for order in range(6, 201)) < 0.6


def test_angles_keep_off_the_nodes_and_reach_every_interval() -> None:
    angles = off_node_angles(np.array(NODES1_DEG), 20)
    nearest = np.abs(angles[:, None] - np.array(NODES1_DEG)).min(axis=1)
    assert nearest.min() >= 0.14 * 20.0
    assert np.bincount(np.searchsorted(NODES1_DEG, angles)).tolist() == [0, *[2] * 10]


def test_the_nodes_are_measured_in_the_papers_order() -> None:
    commands = measuring_sequence(NODES1_DEG, NODES2_DEG, 20)
    assert [command.index for command in commands] == list(range(372))
    at_nodes = [
        (c.theta1_deg, c.theta2_deg, c.direction1, c.direction2)
        for c in commands
        if c.theta1_deg in NODES1_DEG and c.theta2_deg in NODES2_DEG
    ]
    paper = bidirectional_sequence(NODES1_DEG, NODES2_DEG)
    assert at_nodes == [(c.theta1_deg, c.theta2_deg, c.direction1, c.direction2) for c in paper]


def test_both_joints_are_between_nodes_from_both_sides() -> None:
    commands = [c for c in measuring_sequence(NODES1_DEG, NODES2_DEG, 20) if c.theta1_deg not in NODES1_DEG]
    assert len(commands) == 20
    assert not any(c.theta2_deg in NODES2_DEG for c in commands)
    states = [(c.direction1, c.direction2) for c in commands]
    assert {state: states.count(state) for state in states} == dict.fromkeys(states, 5)
    assert len(set(states)) == 4


def test_the_first_joint_stops_on_its_way() -> None:
    commands = measuring_sequence(NODES1_DEG, NODES2_DEG, 24)
    for before, after in pairwise(commands):
        if before.direction1 == after.direction1:
            assert (after.theta1_deg - before.theta1_deg) * after.direction1 >= 0.0


def test_each_command_is_measured_on_the_flank_it_claims() -> None:
    stops = with_take_up(measuring_sequence(NODES1_DEG, NODES2_DEG, 24), 1.0)
    assert_on_the_claimed_flanks(stops, 0.999, (0.0, 0.0))


def test_a_measurement_stops_between_nodes_by_default() -> None:
    plan = OpenLoop().plan(bench(), OpenLoopParams(reflectors=["P2"], closures=0))
    assert (usual_count(NODES1_DEG), usual_count((0.0, 20.0))) == (12, 2)
    assert len(plan.reflectors[0].visits) + len(plan.reflectors[0].blind) == 364
    without = OpenLoop().plan(bench(), OpenLoopParams(reflectors=["P2"], closures=0, off_node=0))
    assert len(without.reflectors[0].visits) + len(without.reflectors[0].blind) == 352
    # Each takes longer than a node by the way of J2 there and back.
    assert plan.duration_s < 1.1 * without.duration_s
