"""Targets that are outside the joints' ranges, or no numbers, move nothing."""

import math

import pytest

from catseye.app.engine.gate import require_in_range
from catseye.app.errors import LimitError
from catseye.drivers.roles.pose import out_of_range
from tests.unit.app.engine.fakes import ARM


@pytest.mark.parametrize("number", range(len(ARM.axes)))
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf, 1e6, -1e6])
def test_every_axis_refuses_what_is_out_of_its_range(number: int, value: float) -> None:
    inside = [0.5 * (axis.low + axis.high) for axis in ARM.axes]
    require_in_range(ARM.axes, tuple(inside))
    inside[number] = value
    with pytest.raises(LimitError, match=f"^{ARM.axes[number].name} = .* the robot was not moved"):
        require_in_range(ARM.axes, tuple(inside))


@pytest.mark.parametrize("end", ["low", "high"])
def test_the_ends_of_a_range_are_allowed(end: str) -> None:
    pose = tuple(getattr(axis, end) for axis in ARM.axes)
    require_in_range(ARM.axes, pose)
    assert out_of_range(ARM.axes, pose) == []
