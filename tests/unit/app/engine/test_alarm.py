"""An alarm that somebody has read is reset, and no other one."""

from dataclasses import replace

import pytest

from catseye.app.engine.alarm import require_no_alarm, reset_read_alarm
from catseye.app.errors import SafetyError
from catseye.drivers.roles.errors import RefusedError
from tests.unit.app.engine.fakes import FakeRobot, ManualClock

READ = (2600, "alarm L2600: position data outside of the range; check the target")


class AlarmedRobot(FakeRobot):
    """In an alarm; resetting it brings what a test says."""

    stays = False
    reset = 0

    async def reset_alarm(self) -> None:
        self.reset += 1
        if not self.stays:
            self.state = replace(self.state, alarm_number=0, alarm_text="")


def alarmed(number: int = READ[0], text: str = READ[1]) -> AlarmedRobot:
    robot = AlarmedRobot(ManualClock())
    robot.state = replace(robot.state, alarm_number=number, alarm_text=text)
    return robot


async def test_the_alarm_that_was_read_is_reset() -> None:
    robot = alarmed()
    await reset_read_alarm(robot, *READ)
    assert robot.reset == 1
    require_no_alarm(await robot.status())


@pytest.mark.parametrize(
    ("robot", "why"),
    [
        (alarmed(50, "external emergency stop"), "another alarm by now, 50: external emergency stop"),
        (alarmed(READ[0], "the same number, another text"), "another alarm by now"),
        (alarmed(0, ""), "the alarm is gone"),
    ],
    ids=["another number", "another text", "gone"],
)
async def test_another_alarm_stays(robot: AlarmedRobot, why: str) -> None:
    with pytest.raises(SafetyError, match=why):
        await reset_read_alarm(robot, *READ)
    assert robot.reset == 0


async def test_nothing_is_reset_while_the_arm_moves() -> None:
    robot = alarmed()
    robot.state = replace(robot.state, running=True)
    with pytest.raises(SafetyError, match="the arm moves"):
        await reset_read_alarm(robot, *READ)
    assert robot.reset == 0


async def test_an_alarm_that_comes_back_is_said() -> None:
    robot = alarmed()
    robot.stays = True
    with pytest.raises(SafetyError, match="is in alarm 2600"):
        await reset_read_alarm(robot, *READ)


async def test_a_robot_whose_alarms_are_confirmed_at_its_pendant_refuses() -> None:
    robot = FakeRobot(ManualClock())
    robot.state = replace(robot.state, alarm_number=1, alarm_text="a message stands on the smartPAD")
    with pytest.raises(RefusedError, match="at its pendant"):
        await reset_read_alarm(robot, 1, "a message stands on the smartPAD")
