"""What is reported of a run that could not be brought to rest."""

from catseye.app.engine.control import RunControl
from catseye.app.engine.ending import ending_of
from catseye.app.engine.halt import HaltReport
from catseye.drivers.roles.errors import LinkError
from tests.unit.app.engine.fakes import ManualClock

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
