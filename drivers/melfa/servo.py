"""Waiting for the drives."""

import asyncio

from catseye.drivers.melfa.session import Session
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import AlarmError, RefusedError


async def servo_is(session: Session, clock: Clock, settings: MelfaSettings, *, on: bool) -> None:
    """Wait until STATE says that the drives are on, or off.

    Raises:
        AlarmError: an alarm keeps them from coming on.
        RefusedError: they do not follow in time.
        LinkError: lost or silent.
    """
    timeout_s = settings.servo_timeout_s
    status = await session.status()
    try:
        async with asyncio.timeout(timeout_s):
            while status.servo_on != on:
                if on and status.alarm_number:
                    raise AlarmError(f"{session.where}: {status.alarm_text}", status.alarm_number)
                await clock.sleep(settings.poll_s)
                status = await session.status()
    except TimeoutError:
        stop = "open" if status.emergency_stop else "closed"
        raise RefusedError(
            f"{session.where}: the servo is not {'on' if on else 'off'} after {timeout_s:g} s, "
            f"emergency stop circuit {stop}, key at {'TEACH' if status.teach_mode else 'AUTO'}: check key "
            "switch, emergency stop, door switch and that the pendant is disabled",
            0,
        ) from None
