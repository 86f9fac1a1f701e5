"""How an arm stands, against the maker's drawing of a KR 210 R2700 and against plain geometry."""

import math

import pytest

from catseye.app.cell.bodies import workspace_of
from catseye.app.protocol.posture import Posture
from catseye.app.service.watching.posture import posture_of
from tests.unit.app.tui.serial.scripted_arm import CELL, HOME

DRAWN_MM = (
    (0.0, 0.0, 0.0),
    (0.0, 0.0, 675.0),
    (350.0, 0.0, 675.0),
    (350.0, 0.0, 1825.0),
    (1550.0, 0.0, 1784.0),
    (1550.0, 0.0, 1784.0),
    (1765.0, 0.0, 1784.0),
)
"""Base, axes 1 to 3, wrist twice, flange: lengths of the data sheet, upper arm upright, forearm level."""


def posture(*joints: float) -> Posture:
    found = posture_of(workspace_of(CELL), joints)
    assert found is not None
    return found


def test_a_kr210_stands_as_its_maker_draws_it() -> None:
    for found, drawn in zip(posture(*HOME).joints_mm, DRAWN_MM, strict=True):
        assert found == pytest.approx(drawn, abs=1e-6)


def test_the_first_axis_turns_heading_and_arm_clockwise() -> None:
    found = posture(30.0, *HOME[1:])
    assert found.heading_deg == pytest.approx(-30.0)
    x_mm, y_mm, z_mm = found.joints_mm[-1]
    assert math.degrees(math.atan2(y_mm, x_mm)) == pytest.approx(-30.0)
    assert (math.hypot(x_mm, y_mm), z_mm) == pytest.approx((1765.0, 1784.0))


def test_bodies_move_with_the_joint_that_carries_them() -> None:
    before, after = posture(*HOME), posture(0.0, -120.0, *HOME[2:])
    moved = {
        limb.name
        for limb, then in zip(after.limbs, before.limbs, strict=True)
        if math.dist(limb.start_mm, then.start_mm) > 1.0 or math.dist(limb.end_mm, then.end_mm) > 1.0
    }
    # The second joint carries neither the base nor what turns with the first one.
    stay = {body.name for body in workspace_of(CELL).bodies if body.frame < 2}
    assert moved == {limb.name for limb in before.limbs} - stay


@pytest.mark.parametrize("joints", [None, (0.0, math.nan, 0.0, 0.0, 0.0, 0.0)])
def test_an_arm_whose_joints_are_not_known_has_no_posture(joints: tuple[float, ...] | None) -> None:
    assert posture_of(workspace_of(CELL), joints) is None
