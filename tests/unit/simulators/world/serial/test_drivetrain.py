"""Twist, friction and creep of transmissions against hand calculation."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.simulators.world.serial.drivetrain import Drive, Drivetrains
from catseye.simulators.world.serial.truth import JointTruth

JOINT = JointTruth(
    name="A",
    stiffness_nm_per_deg=20_000.0,
    play_deg=0.008,
    engagement_nm=1.0,
    link_friction_nm=30.0,
    friction_waviness=0.0,
    presliding_deg=1e-3,
    creep=0.05,
    creep_s=0.5,
    motor_friction_nm=7.0,
    static_friction_nm=1.5,
    servo_nm_per_deg=4000.0,
    stop_scatter_deg=0.0,
    stop_window_deg=0.0,
)
ONE = Drivetrains([JOINT])


def at(load_nm: float) -> Drive:
    return ONE.at_rest(np.zeros(1), np.array([load_nm]))


def driven(start: Drive, *motors_deg: float) -> Drive:
    for motor in motors_deg:
        start = ONE.driven(start, np.array([motor]), start.hold_nm)
    return start


def lost_motion_deg(load_nm: float) -> float:
    forth = driven(at(load_nm), 1.0)
    back = driven(forth, 2.0, 1.0)
    return float(back.link_deg[0] - forth.link_deg[0])


def test_a_balanced_joint_loses_play_and_torsion_at_reversal() -> None:
    # Play 0.008°, and the torsion of 30 N m forth and 30 N m back at 20 000 N m/deg.
    assert lost_motion_deg(0.0) == pytest.approx(0.008 + 2.0 * 30.0 / 20_000.0, abs=1e-6)


def test_a_loaded_joint_loses_torsion_alone() -> None:
    assert lost_motion_deg(100.0) == pytest.approx(2.0 * 30.0 / 20_000.0, abs=1e-6)


def test_first_steps_after_a_reversal_are_flattened_not_lost() -> None:
    start = driven(at(0.0), 1.0)
    turned = driven(start, 0.999)
    moved_deg = float(start.link_deg[0] - turned.link_deg[0])
    assert 0.0 < moved_deg < 0.5e-3


def test_links_follow_a_way_in_one_direction_without_loss() -> None:
    start = driven(at(5.0), 1.0)
    assert driven(start, 1.5).link_deg[0] - start.link_deg[0] == pytest.approx(0.5, abs=1e-9)


@given(
    load_nm=st.floats(-200.0, 200.0),
    motors_deg=st.lists(st.floats(1e-6, 0.02), min_size=2, max_size=6),
    sense=st.sampled_from((-1.0, 1.0)),
)
def test_pieces_of_a_way_lead_where_the_whole_does(
    load_nm: float, motors_deg: list[float], sense: float
) -> None:
    start = driven(at(load_nm), 1.0)
    ways = 1.0 + sense * np.cumsum(motors_deg)
    whole, pieces = driven(start, float(ways[-1])), driven(start, *ways.tolist())
    np.testing.assert_allclose(pieces.link_deg, whole.link_deg, rtol=0.0, atol=1e-9)
    np.testing.assert_allclose(pieces.friction_nm, whole.friction_nm, rtol=0.0, atol=1e-4)


def test_a_rest_lets_a_part_of_the_friction_creep_away() -> None:
    start = driven(at(100.0), 1.0)
    rested = ONE.rested(start, np.array([1e3]))
    assert rested.friction_nm[0] == pytest.approx(0.95 * 30.0, rel=1e-6)
    # The torsion of those 1.5 N m turns the link on.
    assert rested.link_deg[0] - start.link_deg[0] == pytest.approx(1.5 / 20_000.0, rel=1e-3)


def test_friction_depends_on_the_place_where_it_is_wavy() -> None:
    wavy = Drivetrains([JOINT.model_copy(update={"friction_waviness": 0.1})])
    # Both waves stand at 0 there and peak at other places.
    assert wavy.wavy(np.zeros(1))[0] == pytest.approx(1.0)
    assert wavy.wavy(np.array([30.0]))[0] == pytest.approx(1.0 + 0.1 * (1.0 + np.sin(np.deg2rad(570.0))))
