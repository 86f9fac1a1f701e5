"""The controller's state from its panel and its program."""

from dataclasses import dataclass
from typing import Final

from catseye.drivers.abb import names
from catseye.drivers.abb.service import Service
from catseye.drivers.abb.values import number_of, states_of, value_of, whole_of
from catseye.drivers.roles.errors import ProtocolError, RefusedError
from catseye.drivers.roles.robot import RobotStatus

FAILURE: Final = 1
GUARD_STOP: Final = 2
"""Alarm numbers of states: the controller tells no number with them."""

_TEXTS: Final = {
    FAILURE: "the system has failed: read the event log at the pendant, remove the cause and restart",
    GUARD_STOP: "a safeguard is open (guard stop): close it, confirm at the pendant, switch the motors on",
}


@dataclass(frozen=True)
class Module:
    """What CATSABB says; None where it is not loaded.

    Attributes:
        taken: number of the order taken last.
        done: number of the order done last.
    """

    taken: int
    done: int


async def module_of(service: Service, task: str) -> Module | None:
    """Return what CATSABB says; None where the controller refuses it, most often since it is not loaded."""
    try:
        taken = await service.value(names.data(task, names.TAKEN), "value")
        done = await service.value(names.data(task, names.DONE), "value")
    except RefusedError:
        return None
    return Module(whole_of(taken), whole_of(done))


async def mains_of(service: Service, task: str) -> list[str]:
    """Return where procedures called main of a task stand, in small letters; none where the controller does not say.

    Raises:
        LinkError: lost or silent.
    """
    try:
        found = states_of(await service.ask(names.main_search(task)))
    except (RefusedError, ProtocolError):
        return []
    places = [str(state.get("symburl", "")).lower() for state in found]
    return [place for place in places if place.endswith("/main")]


def own_main(task: str) -> str:
    """Return where main of CATSABB stands, as `mains_of` says it."""
    return f"RAPID/{task}/{names.MODULE}/main".lower()


async def status_of(service: Service, task: str) -> RobotStatus:
    """Return the state.

    Raises:
        RefusedError: the controller does not say.
        LinkError: lost or silent.
        ProtocolError: garbage came.
    """
    state = await service.value(names.CONTROL_STATE, "ctrlstate")
    mode = await service.value(names.MODE, "opmode")
    ratio = value_of(await service.ask(names.SPEED_RATIO), "speedratio")
    executes = await service.value(names.EXECUTION, "ctrlexecstate") == names.RUNNING
    module = await module_of(service, task)
    manual = mode in names.MANUAL
    alarm = FAILURE if state == "sysfail" else GUARD_STOP if state == "guardstop" and not manual else 0
    return RobotStatus(
        servo_on=state == names.MOTORS_ON,
        running=executes and await _may_move(service, task, module),
        operation_enabled=mode == names.AUTO and module is not None,
        teach_mode=manual,
        emergency_stop=state in names.EMERGENCY,
        override_percent=number_of(ratio),
        alarm_number=alarm,
        alarm_text=_TEXTS.get(alarm, ""),
        program=names.MODULE if module is not None else "",
    )


async def _may_move(service: Service, task: str, module: Module | None) -> bool:
    """Return whether the program that runs may move the arm: CATSABB with an order does, another one at any time."""
    if module is None or module.taken != module.done:
        return True
    mains = await mains_of(service, task)
    return bool(mains) and own_main(task) not in mains
