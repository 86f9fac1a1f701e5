"""How an ABB robot is stopped on one connection, and seen to stand."""

from typing import Final

from catseye.drivers.abb import names
from catseye.drivers.abb.service import Service
from catseye.drivers.abb.values import JOINTS, number_of, states_of
from catseye.drivers.links.link import RequestLink
from catseye.drivers.roles.errors import ProtocolError, RefusedError
from catseye.drivers.roles.pose import Pose

STILL_DEG: Final = 1e-3
"""A tenth of what joints move in a few polls at 1 % of 250 °/s; texts of joints may have six digits."""


async def joints_of(service: Service, unit: str) -> Pose:
    """Return the joints of a mechanical unit, deg.

    Raises:
        RefusedError: there is no such unit.
        LinkError: lost or silent.
        ProtocolError: garbage came.
    """
    states = states_of(await service.ask(names.joint_target(unit)))
    if not states:
        raise ProtocolError(f"{service.where}: the answer has no joints")
    return tuple(number_of(states[0].get(joint)) for joint in JOINTS)


class AbbStopper:
    """Stops and looks on one connection; see `Stopper` of the links.

    Args:
        unit: mechanical unit of the arm.
    """

    def __init__(self, service: Service, unit: str) -> None:
        self._service = service
        self._unit = unit

    @property
    def link(self) -> RequestLink:
        """The connection."""
        return self._service.link

    def stop_bytes(self) -> bytes:
        """Return what stops the arm."""
        return self._service.stop_bytes()

    async def stop(self) -> None:
        """Stop RAPID; a controller may refuse to stop what stands already."""
        try:
            await self._service.ask(names.STOP)
        except RefusedError:
            if await self._runs():
                raise

    async def look(self) -> tuple[Pose, bool]:
        """Return where the joints are, and whether a program may still move them."""
        running = await self._runs()
        return await joints_of(self._service, self._unit), running

    async def _runs(self) -> bool:
        return await self._service.value(names.EXECUTION, "ctrlexecstate") == names.RUNNING
