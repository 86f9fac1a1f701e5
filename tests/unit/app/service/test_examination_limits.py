"""What doctor says about the controller's own limits."""

import pytest

from catseye.app.service.examination import look_at_limits
from catseye.drivers.roles.errors import ProtocolError, RefusedError
from catseye.drivers.roles.pose import Range
from tests.unit.app.engine.fakes import ARM, FakeRobot, ManualClock

WIDE: tuple[Range, ...] = ((-170.0, 170.0), (-145.0, 145.0), (0.0, 150.0), (-360.0, 360.0))


class LimitedRobot(FakeRobot):
    """Says its limits, or why it does not."""

    answer: tuple[Range, ...] | Exception = WIDE

    async def joint_limits(self) -> tuple[Range, ...]:
        if isinstance(self.answer, Exception):
            raise self.answer
        return self.answer


def robot(answer: tuple[Range, ...] | Exception) -> LimitedRobot:
    made = LimitedRobot(ManualClock())
    made.answer = answer
    return made


async def test_limits_that_hold_the_cells_need_nothing() -> None:
    facts, advice = await look_at_limits(robot(WIDE), ARM)
    assert facts == ["controller's limits (MEJAR): J1 -170…170, J2 -145…145, J3 0…150, J4 -360…360"]
    assert advice == []


async def test_limits_narrower_than_the_cells_call_for_something() -> None:
    _, (advice,) = await look_at_limits(robot(((-120.0, 170.0), *WIDE[1:])), ARM)
    assert "limits_deg.j1 = [-170, 170]" in advice
    assert "-120…170" in advice


@pytest.mark.parametrize("error", [RefusedError("no MEJAR", 0), ProtocolError("garbage")])
async def test_a_robot_without_readable_limits_can_be_used(error: Exception) -> None:
    facts, advice = await look_at_limits(robot(error), ARM)
    assert "not answered by this controller" in facts[0]
    assert advice == []


async def test_a_robot_without_limits_of_its_own_is_passed_over() -> None:
    assert await look_at_limits(FakeRobot(ManualClock()), ARM) == ([], [])
