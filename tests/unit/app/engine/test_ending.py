"""What is reported of a run that could not be brought to rest."""

from catseye.app.engine.control import RunControl
from catseye.app.engine.ending import ending_of
from catseye.app.engine.halt import HaltLimits, HaltReport, halt
from catseye.drivers.roles.errors import LinkError
from catseye.drivers.roles.robot import RobotStatus
from tests.unit.app.engine.fakes import FakeRobot, ManualClock

CAUSE = "robot at tcp://192.168.0.20:10001: the connection broke: check cable and power"


def reported(report: str) -> str:
    control = RunControl(ManualClock(), lambda _state, _reason: None)
    control.reports.append(HaltReport(standstill=False, servo_off=False, text=report))
    return ending_of(control, LinkError(CAUSE)).text


def test_the_emergency_stop_comes_first_and_the_cause_only_once() -> None:
    text = reported(f"the drives do not switch off. The stop was answered with: {CAUSE}")
    assert text.startswith("PRESS THE EMERGENCY STOP: standstill is not confirmed; the drives")
    assert text.count(CAUSE) == 1


def test_another_cause_is_reported_before_the_trouble() -> None:
    text = reported("the drives do not switch off")
    assert text.endswith(f"{CAUSE}; the drives do not switch off")


GONE = "tcp://192.168.0.20:80: cannot connect (Connection refused): check that the instrument is switched on"
STOPPING = f"robot (stop connection): STOP was written, but the standstill is not confirmed ({GONE})"
UNSEEN = "robot at tcp://192.168.0.20:80: nothing was seen of a motion for 2 s, so it is stopped"


class DeadLink(FakeRobot):
    """Nothing of it answers any more."""

    async def stop(self) -> None:
        raise LinkError(STOPPING)

    async def status(self) -> RobotStatus:
        raise LinkError(GONE)

    async def servo(self, *, on: bool) -> None:
        del on
        raise LinkError(GONE)


async def test_a_dead_link_is_told_once() -> None:
    clock = ManualClock()
    control = RunControl(clock, lambda _state, _reason: None)
    control.reports.append(await halt(DeadLink(clock), clock, HaltLimits(), lambda: None))
    cause = LinkError(UNSEEN)
    cause.add_note(STOPPING)
    text = ending_of(control, cause).text
    assert text.startswith(
        "PRESS THE EMERGENCY STOP: standstill is not confirmed, and the drives do not switch off"
    )
    assert [text.count(part) for part in (UNSEEN, STOPPING, GONE, "PRESS")] == [1, 1, 1, 1]
