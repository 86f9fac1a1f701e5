"""What doctor says about the controller's state."""

from dataclasses import replace
from typing import Any

import pytest

from catseye.app.service.examination import look_at_robot
from tests.unit.app.engine.fakes import ARM, FakeRobot, ManualClock


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"teach_mode": True}, "key switch is at TEACH"),
        ({"machine_locked": True}, "machine lock is on, the arm does not move: switch it off"),
        ({"emergency_stop": True}, "emergency stop is pressed"),
    ],
)
async def test_a_state_that_keeps_the_arm_is_named(change: dict[str, Any], words: str) -> None:
    robot = FakeRobot(ManualClock())
    robot.state = replace(robot.state, **change)
    _, (advice,) = await look_at_robot(robot, ARM)
    assert words in advice
