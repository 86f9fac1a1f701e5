"""What is left of a way on which an arm was stopped."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.engine.mover import rest_of_way
from catseye.drivers.roles.pose import Pose

START: Pose = (0.0, 0.0, 0.0, 0.0)
WAY: tuple[Pose, ...] = ((10.0, 20.0, 0.0, 40.0), (10.0, -20.0, 0.0, 40.0), (30.0, -20.0, 5.0, 0.0))


@given(leg=st.integers(0, 2), share=st.floats(0.02, 0.98))
def test_an_arm_on_a_leg_goes_on_to_its_end(leg: int, share: float) -> None:
    a, b = (START, *WAY)[leg], WAY[leg]
    one, two, three, four = (x + share * (y - x) for x, y in zip(a, b, strict=True))
    assert rest_of_way(START, WAY, (one, two, three, four)) == WAY[leg:]


@pytest.mark.parametrize("here", [(10.0, 0.0, 0.0, 60.0), (0.0, 0.0, -1.0, 0.0), (40.0, -20.0, 5.0, -20.0)])
def test_an_arm_beside_its_way_has_none(here: Pose) -> None:
    assert rest_of_way(START, WAY, here) is None


def test_a_way_of_no_length_is_its_target() -> None:
    assert rest_of_way(START, (START,), START) == (START,)
