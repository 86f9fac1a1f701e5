"""STOP: written past everything on every connection, repeated until the arm is seen to stand."""

import asyncio
from collections.abc import Sequence
from typing import Final

from catseye.drivers.kuka import names
from catseye.drivers.kuka.proxy import Proxy, stop_bytes
from catseye.drivers.kuka.settings import KukaSettings
from catseye.drivers.kuka.values import axes_of, flag_of, symbol_of
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError, LinkError
from catseye.drivers.roles.pose import Pose, is_at

HELD: Final = {names.STOP: "TRUE"}
"""What the program brakes at, and what keeps it from taking an order."""

STOP: Final = {**HELD, names.OVERRIDE: "0"}
"""What stops the arm: the program brakes at the first, and at an override of 0 no program moves anything."""

STOP_BYTES: Final = stop_bytes(STOP)

PERIOD_S: Final = 0.1
"""Between two STOPs when one does not get through, real s."""

_STILL_DEG: Final = 1e-4
"""The slowest motion, 0.01 % of 100 °/s, commands more than this in a few polls."""

_STILL_LOOKS: Final = 4
_PRESS: Final = "PRESS THE EMERGENCY STOP if the robot moves"


class Halt:
    """One stop of the robot.

    Args:
        proxies: every connection on which STOP is written and the arm is looked at.
        clock: time of the polls.
    """

    def __init__(self, proxies: Sequence[Proxy], clock: Clock, settings: KukaSettings) -> None:
        self._proxies = proxies
        self._clock = clock
        self._settings = settings
        self._refusals: list[str] = []

    def send(self) -> None:
        """Hand STOP to the operating system on every connection; waits for nothing."""
        for proxy in self._proxies:
            self._write(proxy)

    async def confirm(self) -> None:
        """Repeat STOP on every connection until one of them sees the arm stand.

        Raises:
            LinkError: nobody says that it stands: use the emergency stop.
        """
        looks = {asyncio.create_task(self._look_until_it_stands(proxy)) for proxy in self._proxies}
        try:
            done, _ = await asyncio.wait(
                looks, timeout=self._settings.stop_timeout_s, return_when=asyncio.FIRST_COMPLETED
            )
        finally:
            for look in looks:
                look.cancel()
            await asyncio.gather(*looks, return_exceptions=True)
            for proxy in self._proxies:
                await proxy.link.end_flood()
        if not done:
            raise LinkError(
                f"{self._proxies[0].where}: STOP was written, but the standstill is not confirmed: {_PRESS} "
                f"({'; '.join(self._refusals[-3:]) or 'the arm moves on'})"
            )
        for look in done:
            look.result()

    def _write(self, proxy: Proxy) -> None:
        try:
            proxy.link.send_urgent(STOP_BYTES, cut=b"")
        except LinkError as exc:
            self._refusals.append(str(exc))

    async def _look_until_it_stands(self, proxy: Proxy) -> None:
        """Stop and look on one connection, which is healed for it, until the arm is at rest."""
        while True:
            try:
                await proxy.write(STOP)
                if await self._rests(proxy):
                    return
            except DeviceError as exc:
                self._refusals.append(str(exc))
            await asyncio.sleep(PERIOD_S)
            self._write(proxy)

    async def _rests(self, proxy: Proxy) -> bool:
        """Return whether the program moves nothing and a few looks see one and the same place."""
        first: Pose | None = None
        for _ in range(_STILL_LOOKS):
            here, busy = await _look(proxy)
            if busy or (first is not None and not is_at(first, here, _STILL_DEG)):
                return False
            first = first or here
            await self._clock.sleep(self._settings.poll_s)
        return True


async def _look(proxy: Proxy) -> tuple[Pose, bool]:
    """Return where the axes are commanded to be, and whether the program says that it moves them."""
    axes, state = await proxy.read_all((names.AXIS_ACT, names.PROGRAM_STATE))
    moving = (await proxy.read_known((names.MOVING,)))[names.MOVING]
    return axes_of(axes), symbol_of(state) == names.ACTIVE and moving is not None and flag_of(moving)
