"""Before the first motion of a process: the arm stands, and no foreign program runs."""

from dataclasses import replace

import pytest

from catseye.app.engine.first_motion import PATIENCE_S, REST_S, require_rest
from catseye.app.errors import SafetyError
from catseye.drivers.roles.pose import Pose
from tests.unit.app.engine.fakes import HOME, FakeRobot, ManualClock


class DriftingRobot(FakeRobot):
    """Moves by itself until a time."""

    until_s = 0.0

    async def joints(self) -> Pose:
        one = 0.5 * min(self.clock.monotonic_s(), self.until_s)
        return (one, *HOME[1:])


class ProgramRobot(FakeRobot):
    """Has a program of its own on the controller."""

    own_program = "CATSDL"


class SlowRobot(FakeRobot):
    """Answers after two seconds, as over a link that has lost an answer; notes when it was asked."""

    def __init__(self, clock: ManualClock) -> None:
        super().__init__(clock)
        self.asked_s: list[float] = []

    async def joints(self) -> Pose:
        self.asked_s.append(self.clock.monotonic_s())
        self.clock.advance(2.0)
        return HOME


async def nobody(_text: str) -> None:
    """Take no note."""


async def test_an_arm_that_stands_is_seen_to_do_so() -> None:
    robot = FakeRobot(ManualClock())
    assert await require_rest(robot, robot.clock, 1.0, nobody) == HOME
    assert robot.clock.monotonic_s() >= REST_S


async def test_slow_answers_do_not_shorten_the_rest() -> None:
    robot = SlowRobot(ManualClock())
    await require_rest(robot, robot.clock, 1.0, nobody)
    first_answered_s = robot.asked_s[0] + 2.0
    assert robot.asked_s[-1] - first_answered_s >= REST_S


async def test_a_motion_left_behind_is_waited_for_and_reported() -> None:
    robot, warnings = DriftingRobot(ManualClock()), list[str]()

    async def warn(text: str) -> None:
        warnings.append(text)

    robot.until_s = 16.0
    place = await require_rest(robot, robot.clock, 1.0, warn)
    assert place[0] == pytest.approx(8.0)
    assert robot.clock.monotonic_s() > 16.0 + 0.9 * REST_S
    assert warnings == ["the arm is moving and nothing of this run moves it: waiting until it stands"]


async def test_an_arm_that_never_rests_is_not_driven() -> None:
    robot = DriftingRobot(ManualClock())
    robot.until_s = 10.0 * PATIENCE_S
    with pytest.raises(SafetyError, match=r"still moving after 30 s.*stop it at the controller"):
        await require_rest(robot, robot.clock, 1.0, nobody)


@pytest.mark.parametrize("kind", [FakeRobot, ProgramRobot])
async def test_a_foreign_program_is_named_and_refused(kind: type[FakeRobot]) -> None:
    robot = kind(ManualClock())
    robot.state = replace(robot.state, running=True, program="PALLET.MB4")
    with pytest.raises(SafetyError, match="program PALLET runs on the controller"):
        await require_rest(robot, robot.clock, 1.0, nobody)


@pytest.mark.parametrize("name", ["CATSDL.MB4", ""])
async def test_a_program_of_the_driver_itself_may_run(name: str) -> None:
    robot = ProgramRobot(ManualClock())
    robot.state = replace(robot.state, running=True, program=name)
    assert await require_rest(robot, robot.clock, 1.0, nobody) == HOME
