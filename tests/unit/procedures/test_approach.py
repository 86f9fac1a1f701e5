"""The measuring sequence and take-up, against a play operator of its own."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.procedures.kit.errors import PlanLimitError
from catseye.procedures.scara.motion.approach import (
    Command,
    Waypoint,
    bidirectional_sequence,
    require_joint_limits,
    with_take_up,
)
from tests.unit.procedures.benches import NODES1_DEG, NODES2_DEG, bench, with_axes

TAKE_UP_DEG = 1.0
nodes = st.lists(st.integers(-4000, 4000), min_size=2, max_size=6, unique=True).map(
    lambda values: tuple(0.03 * value for value in sorted(values))
)


class Play:
    """A joint behind a play: the output rests until the gap is used up (a play operator of its own)."""

    def __init__(self, gap: float, command: float, flank: float) -> None:
        self.gap = gap
        self.output = command + flank * gap / 2

    def go(self, command: float) -> float:
        if command - self.output > self.gap / 2:
            self.output = command - self.gap / 2
        elif self.output - command > self.gap / 2:
            self.output = command + self.gap / 2
        return self.output


def assert_on_the_claimed_flanks(stops: tuple[Waypoint, ...], gap: float, home: tuple[float, float]) -> None:
    for flank in (1.0, -1.0):
        joints = [Play(gap, home[0], flank), Play(gap, home[1], flank)]
        for stop in stops:
            angles = (stop.theta1_deg, stop.theta2_deg)
            actual = [joint.go(angle) for joint, angle in zip(joints, angles, strict=True)]
            if stop.command is None:
                continue
            claimed = (stop.command.direction1, stop.command.direction2)
            for angle, real, direction in zip(angles, actual, claimed, strict=True):
                # Moved upwards, the joint trails below its command; moved downwards, above it.
                assert real - angle == pytest.approx(-direction * gap / 2, abs=1e-9), stop


def test_the_papers_sequence_has_352_commands() -> None:
    commands = bidirectional_sequence(NODES1_DEG, NODES2_DEG)
    assert len(commands) == 22 * 16 == 352
    assert [command.index for command in commands] == list(range(352))
    places = {(c.theta1_deg, c.theta2_deg) for c in commands}
    assert len(places) == 88
    states = {(c.theta1_deg, c.theta2_deg, c.direction1, c.direction2) for c in commands}
    assert len(states) == 352


def test_the_sequence_turns_at_its_ends() -> None:
    commands = bidirectional_sequence(NODES1_DEG, NODES2_DEG)
    assert commands[0] == Command(0, -140.0, 0.0, 1, 1)
    assert commands[7] == Command(7, -140.0, 140.0, 1, 1)
    assert commands[8] == Command(8, -140.0, 140.0, 1, -1)
    assert commands[15] == Command(15, -140.0, 0.0, 1, -1)
    assert commands[16] == Command(16, -120.0, 0.0, 1, 1)
    assert commands[175] == Command(175, 60.0, 0.0, 1, -1)
    assert commands[176] == Command(176, 60.0, 0.0, -1, 1)
    assert commands[351] == Command(351, -140.0, 0.0, -1, -1)


@given(nodes, nodes, st.sampled_from([0.1, 0.5, 0.999]), st.sampled_from([(0.0, 0.0), (-130.0, 119.0)]))
def test_every_node_is_measured_on_the_flank_it_claims(
    nodes1: tuple[float, ...], nodes2: tuple[float, ...], share: float, home: tuple[float, float]
) -> None:
    stops = with_take_up(bidirectional_sequence(nodes1, nodes2), TAKE_UP_DEG)
    assert_on_the_claimed_flanks(stops, share * TAKE_UP_DEG, home)


@given(
    st.lists(
        st.tuples(
            st.integers(-30, 30), st.integers(-30, 30), st.sampled_from([1, -1]), st.sampled_from([1, -1])
        ),
        min_size=1,
        max_size=12,
    )
)
def test_commands_in_any_order_are_measured_on_their_flanks(
    rows: list[tuple[int, int, int, int]],
) -> None:
    commands = tuple(Command(i, 0.3 * a, 0.3 * b, s, t) for i, (a, b, s, t) in enumerate(rows))
    stops = with_take_up(commands, TAKE_UP_DEG)
    assert [stop.command for stop in stops if stop.command is not None] == list(commands)
    assert_on_the_claimed_flanks(stops, 0.999 * TAKE_UP_DEG, (3.0, -3.0))


def test_without_take_up_reversals_stay_on_the_old_flank() -> None:
    stops = tuple(
        Waypoint(c.theta1_deg, c.theta2_deg, c) for c in bidirectional_sequence(NODES1_DEG, NODES2_DEG)
    )
    with pytest.raises(AssertionError):
        assert_on_the_claimed_flanks(stops, 0.02, (0.0, 0.0))


def test_take_ups_stand_only_where_a_sweep_begins() -> None:
    stops = with_take_up(bidirectional_sequence(NODES1_DEG, NODES2_DEG), TAKE_UP_DEG)
    # Each of the 22 J1 nodes has two sweeps of J2, and each sweep begins with one take-up.
    assert len(stops) == 352 + 2 * 22
    before = [
        after.command.index
        for stop, after in pairwise(stops)
        if stop.command is None and after.command is not None
    ]
    assert before == list(range(0, 352, 8))


def test_a_joint_that_stands_still_is_left_alone() -> None:
    commands = (Command(0, 0.0, 0.0, 1, 1), Command(1, 0.0, 20.0, 1, 1), Command(2, 0.0, 20.0, 1, -1))
    stops = with_take_up(commands, TAKE_UP_DEG)
    assert [(stop.theta1_deg, stop.theta2_deg) for stop in stops] == [
        (-1.0, -1.0),
        (0.0, 0.0),
        (0.0, 20.0),
        (0.0, 21.0),
        (0.0, 20.0),
    ]


def test_a_reversal_with_room_needs_no_take_up() -> None:
    commands = (Command(0, 0.0, 0.0, 1, 1), Command(1, -20.0, -1.0, -1, -1))
    assert [stop.command for stop in with_take_up(commands, TAKE_UP_DEG)[1:]] == list(commands)


@pytest.mark.parametrize(
    ("nodes1", "nodes2", "joint", "kind"),
    [
        ((-169.5, 0.0), (0.0, 20.0), "J1 = -170.5°", "take-up position"),
        ((0.0, 169.5), (0.0, 20.0), "J1 = 170.5°", "take-up position"),
        ((0.0, 20.0), (-144.5, 20.0), "J2 = -145.5°", "take-up position"),
        ((0.0, 175.0), (0.0, 20.0), "J1 = 175°", "a node"),
        ((0.0, 20.0), (0.0, 150.0), "J2 = 150°", "a node"),
    ],
)
def test_a_stop_outside_the_limits_is_named(
    nodes1: tuple[float, ...], nodes2: tuple[float, ...], joint: str, kind: str
) -> None:
    stops = with_take_up(bidirectional_sequence(nodes1, nodes2), TAKE_UP_DEG)
    with pytest.raises(PlanLimitError) as caught:
        require_joint_limits(stops, bench())
    assert joint in str(caught.value)
    assert kind in str(caught.value)
    assert "take_up_deg (now 1°)" in str(caught.value)


def test_stops_on_the_limits_are_allowed() -> None:
    stops = with_take_up(bidirectional_sequence((-169.0, 169.0), (-144.0, 144.0)), TAKE_UP_DEG)
    require_joint_limits(stops, bench())
    narrow = with_axes(bench(), j1_deg=(-169.9, 170.0))
    with pytest.raises(PlanLimitError, match=r"-170°, outside its limits -169\.9°"):
        require_joint_limits(stops, narrow)
