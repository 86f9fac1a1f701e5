"""Resetting a controller's alarm between runs, for a client that has read it."""

from catseye.app.engine.alarm import reset_read_alarm
from catseye.app.errors import CatseyeError
from catseye.app.protocol.answers import Answer
from catseye.app.protocol.requests import ResetAlarm
from catseye.app.protocol.run_events import WarningIssued
from catseye.app.service.errors import refusal_of
from catseye.app.service.manual.device_loan import ManualBench
from catseye.drivers.roles.errors import DeviceError


async def reset_alarm(bench: ManualBench, request: ResetAlarm, who: str) -> Answer:
    """Reset the alarm, owning the arm meanwhile; every client hears of it.

    Raises:
        RefusedError: nothing was reset, or it did not help; the text says why.
    """
    try:
        async with bench.pool.acquired_robot("robot") as robot, bench.owned("its alarm is reset"):
            await reset_read_alarm(robot, request.number, request.text)
    except (CatseyeError, DeviceError) as error:
        raise refusal_of(error) from error
    bench.announce(WarningIssued(text=f"{who} has reset the alarm {request.number}: {request.text}"))
    return Answer()
