"""The controller's state from its panel and its program."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Final

from catseye.drivers.abb import names
from catseye.drivers.abb.service import Service
from catseye.drivers.abb.values import number_of, states_of, value_of, whole_of
from catseye.drivers.links.healing import Repeat
from catseye.drivers.roles.errors import LinkTimeoutError, ProtocolError, RefusedError
from catseye.drivers.roles.robot import RobotStatus

FAILURE: Final = 1
GUARD_STOP: Final = 2
"""Alarm numbers of states: the controller tells no number with them."""

SEARCHED_S: Final = 10.0
"""For so long whose main runs is not searched again, real s."""

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


async def mains_of(service: Service, task: str, *, repeat: Repeat = Repeat.HARMLESS) -> list[str]:
    """Return where procedures called main of a task stand, in small letters; none where the controller does not say.

    Args:
        repeat: what may be done when the answer is lost.

    Raises:
        LinkError: lost or silent.
    """
    try:
        found = states_of(await service.ask(names.main_search(task), repeat=repeat))
    except (RefusedError, ProtocolError):
        return []
    places = [str(state.get("symburl", "")).lower() for state in found]
    return [place for place in places if place.endswith("/main")]


async def mains_if_answered(service: Service, task: str) -> list[str]:
    """Return what `mains_of` does; none where no answer comes in time: a long search is no fault of the link.

    Raises:
        LinkError: lost.
    """
    try:
        return await mains_of(service, task, repeat=Repeat.NEVER)
    except LinkTimeoutError:
        return []


def own_main(task: str) -> str:
    """Return where main of CATSABB stands, as `mains_of` says it."""
    return f"RAPID/{task}/{names.MODULE}/main".lower()


def other_program(task: str, mains: Sequence[str]) -> str:
    """Return the module in capitals whose main runs where it is not that of CATSABB; empty where nobody knows.

    Args:
        mains: of the task, as `mains_of` says them.
    """
    return "" if not mains or own_main(task) in mains else mains[0].split("/")[-2].upper()


class StateReader:
    """Reads the state of one controller.

    Whose program runs without an order takes a search through all symbols of the task. What that finds holds until
    RAPID is seen to stand, and for `SEARCHED_S` at most.
    """

    def __init__(self, service: Service, task: str) -> None:
        self._service = service
        self._task = task
        self._mains: list[str] | None = None
        self._searched_s = 0.0

    def forget(self) -> None:
        """Search anew before the next answer: the controller may be another one."""
        self._mains = None

    async def status(self) -> RobotStatus:
        """Return the state.

        Raises:
            RefusedError: the controller does not say.
            LinkError: lost or silent.
            ProtocolError: garbage came.
        """
        service = self._service
        state = await service.value(names.CONTROL_STATE, "ctrlstate")
        mode = await service.value(names.MODE, "opmode")
        ratio = value_of(await service.ask(names.SPEED_RATIO), "speedratio")
        executes = await service.value(names.EXECUTION, "ctrlexecstate") == names.RUNNING
        module = await module_of(service, self._task)
        manual = mode in names.MANUAL
        alarm = FAILURE if state == "sysfail" else GUARD_STOP if state == "guardstop" and not manual else 0
        if not executes:
            self.forget()
        busy = module is not None and module.taken != module.done
        mains = await self._known_mains() if executes and not busy else [own_main(self._task)]
        own = own_main(self._task) in mains
        return RobotStatus(
            servo_on=state == names.MOTORS_ON,
            # Another program than CATSABB may move the arm always, one of which nobody knows whose it is, too.
            running=executes and (busy or not own or module is None),
            operation_enabled=mode == names.AUTO and module is not None,
            teach_mode=manual,
            emergency_stop=state in names.EMERGENCY,
            override_percent=number_of(ratio),
            alarm_number=alarm,
            alarm_text=_TEXTS.get(alarm, ""),
            program=other_program(self._task, mains)
            if not own
            else names.MODULE
            if module is not None
            else "",
        )

    async def _known_mains(self) -> list[str]:
        now_s = asyncio.get_running_loop().time()
        if self._mains is None or now_s - self._searched_s > SEARCHED_S:
            self._mains = await mains_if_answered(self._service, self._task)
            self._searched_s = now_s
        return self._mains
