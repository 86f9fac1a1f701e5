"""How a KUKA is stopped on one connection, and seen to stand."""

from typing import Final

from catseye.drivers.kuka import names
from catseye.drivers.kuka.proxy import Proxy, stop_bytes
from catseye.drivers.kuka.values import axes_of, flag_of, symbol_of
from catseye.drivers.links.link import RequestLink
from catseye.drivers.roles.pose import Pose

HELD: Final = {names.STOP: "TRUE"}
"""What the program brakes at, and what keeps it from taking an order."""

STOP: Final = {**HELD, names.OVERRIDE: "0"}
"""What stops the arm: the program brakes at the first, and at an override of 0 no program moves anything."""

STOP_BYTES: Final = stop_bytes(STOP)

STILL_DEG: Final = 1e-4
"""The slowest motion, 0.01 % of 100 °/s, commands more than this in a few polls."""


class KukaStopper:
    """Stops and looks on one connection; see `Stopper` of the links."""

    def __init__(self, proxy: Proxy) -> None:
        self._proxy = proxy

    @property
    def link(self) -> RequestLink:
        """The connection."""
        return self._proxy.link

    def stop_bytes(self) -> bytes:
        """Return what stops the arm."""
        return STOP_BYTES

    async def stop(self) -> None:
        """Write the stop variable and an override of 0."""
        await self._proxy.write(STOP)

    async def look(self) -> tuple[Pose, bool]:
        """Return where the axes are commanded to be, and whether the program says that it moves them."""
        axes, state = await self._proxy.read_all((names.AXIS_ACT, names.PROGRAM_STATE))
        moving = (await self._proxy.read_known((names.MOVING,)))[names.MOVING]
        return axes_of(axes), symbol_of(state) == names.ACTIVE and moving is not None and flag_of(moving)
