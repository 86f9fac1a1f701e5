"""A way is clear or not between its targets too."""

import numpy as np
import pytest

from catseye.calibration.kinematics.bodies import Box, Capsule, Gaps, Scene, Table
from catseye.calibration.kinematics.chain import Chain, Joint
from catseye.calibration.kinematics.sweep import RESOLUTION_MM, first_contact

SLIDE = Chain(
    (
        Joint("X", "prismatic", 90.0, 0.0, 0.0, 0.0, 1.0, -1000.0, 1000.0),
        Joint("Z", "prismatic", -90.0, 0.0, 0.0, 0.0, 1.0, -1000.0, 1000.0),
    )
)
"""Its second frame is at (0, -X, Z)."""

BALL = Capsule("ball", 2, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 10.0)
PIN = Capsule("pin", 0, (0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 0.5)


def gaps(**around: object) -> Gaps:
    return Gaps(Scene(SLIDE, (BALL,), **around))  # type: ignore[arg-type]  # each test says what it adds


def way(*targets: tuple[float, float]) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    return np.array(targets)


def test_a_thin_pin_between_two_far_targets_is_found() -> None:
    contact = first_contact(gaps(stands=(PIN,)), way((-900.0, 0.0), (813.0, 0.0)), 1.0)
    assert contact is not None
    assert contact.pair == ("ball", "pin")
    assert -900.0 + contact.clear_share * 1713.0 == pytest.approx(-11.5, abs=1.5 * RESOLUTION_MM)
    assert contact.distance_mm < 0.0


@pytest.mark.parametrize(("height_mm", "clear"), [(13.0, True), (11.9, False)])
def test_the_clearance_decides(height_mm: float, clear: bool) -> None:
    contact = first_contact(gaps(stands=(PIN,)), way((-900.0, height_mm), (800.0, height_mm)), 1.0)
    assert (contact is None) is clear


def test_the_first_of_two_contacts_names_its_leg() -> None:
    pins = (Capsule("later", 0, (0.0, -500.0, 0.0), (0.0, -500.0, 1.0), 0.5), PIN)
    contact = first_contact(gaps(stands=pins), way((-300.0, 0.0), (-200.0, 0.0), (900.0, 0.0)), 1.0)
    assert contact is not None
    assert (contact.leg, contact.pair) == (1, ("ball", "pin"))


def test_a_table_boxes_and_walls_stop_a_body() -> None:
    low = first_contact(gaps(table=Table("table", 0.0)), way((0.0, 50.0), (0.0, 14.0)), 5.0)
    box = Box("box", (-5.0, -60.0, -5.0), (5.0, -50.0, 5.0))
    hit = first_contact(gaps(keep_out=(box,)), way((0.0, 0.0), (200.0, 0.0)), 5.0)
    fence = Box("fence", (-100.0, -100.0, -100.0), (100.0, 100.0, 100.0))
    out = first_contact(gaps(keep_in=(fence,)), way((0.0, 0.0), (86.0, 0.0)), 5.0)
    assert [None if one is None else one.pair[1] for one in (low, hit, out)] == ["table", "box", "fence"]
    assert first_contact(gaps(keep_in=(fence,)), way((0.0, 0.0), (84.0, 0.0)), 5.0) is None


def test_a_blended_corner_is_checked_on_its_inside() -> None:
    corner = way((-100.0, 0.0), (0.0, 0.0), (0.0, 100.0))
    inside = Capsule("post", 0, (0.0, 24.0, 24.0), (0.0, 24.0, 24.0), 1.0)
    passed = np.array([False, True, False])
    assert first_contact(gaps(stands=(inside,)), corner, 5.0) is None
    assert first_contact(gaps(stands=(inside,)), corner, 5.0, passed) is not None


def test_an_arm_that_stands_is_judged_where_it_stands() -> None:
    assert first_contact(gaps(stands=(PIN,)), way((0.0, 0.0)), 1.0) is not None
    assert first_contact(gaps(stands=(PIN,)), way((0.0, 40.0)), 1.0) is None


def test_a_neighbour_beside_the_joint_is_run_into() -> None:
    turn = Chain((Joint("J1", "revolute", 0.0, 0.0, 0.0, 0.0, 1.0, -170.0, 170.0),))
    link = Capsule("link", 1, (0.0, 0.0, 400.0), (300.0, 0.0, 400.0), 60.0)
    column = Capsule("column", 0, (0.0, 0.0, 0.0), (0.0, 0.0, 400.0), 110.0)
    post = Capsule("post", 0, (0.0, 250.0, 0.0), (0.0, 250.0, 500.0), 20.0)
    found = Gaps(Scene(turn, (column, link, post)))
    assert found.pairs == [("link", "post")]
    # The link's side is 85 mm from the post's axis where the two keep 5 mm.
    contact = first_contact(found, np.array([[0.0], [90.0]]), 5.0)
    assert contact is not None
    assert 90.0 * contact.clear_share == pytest.approx(np.degrees(np.arccos(85.0 / 250.0)), abs=0.1)


def test_neighbours_that_meet_at_their_joint_are_not_compared() -> None:
    carriage = Capsule("carriage", 1, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 50.0)
    rail = Capsule("rail", 0, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 10.0)
    assert Gaps(Scene(SLIDE, (rail, carriage, BALL))).pairs == [("ball", "rail")]


def test_a_way_through_no_number_is_refused() -> None:
    with pytest.raises(ValueError, match="not finite"):
        first_contact(gaps(stands=(PIN,)), way((0.0, 40.0), (float("nan"), 40.0)), 1.0)
