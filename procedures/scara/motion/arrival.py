"""The first way of a process: it is planned and checked when it is known where the arm stands."""

from catseye.drivers.roles.pose import Pose, is_at
from catseye.procedures.kit.context import Context
from catseye.procedures.scara.bench import ScaraBench
from catseye.procedures.scara.motion.entry import way_in


class Arrival:
    """Brings the arm to the first pose of this process; the ways from there on are checked by the plan."""

    def __init__(self, ctx: Context, bench: ScaraBench) -> None:
        self._ctx = ctx
        self._bench = bench
        self._over = False

    async def at(self, pose: Pose) -> None:
        """Go to a pose by a free way, once.

        Raises:
            WayBlockedError: a reflector stands in every way.
        """
        if self._over:
            return
        here = await self._ctx.joints()
        if not is_at(here, pose):
            for target in way_in(here, pose, self._bench):
                await self._ctx.move(target)
        self._over = True
