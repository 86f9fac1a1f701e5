"""One joint motion over the R-protocol: the target goes into a variable, the motion takes it from there, once."""

from collections.abc import Awaitable, Callable
from functools import partial

from catseye.drivers.links.healing import Repeat
from catseye.drivers.melfa.connections import Connections
from catseye.drivers.melfa.motion import (
    LOOK_WHY,
    answered,
    asking_under_way,
    assignment,
    off_target,
    require_unlocked,
    sent_once,
    standstill,
)
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import (
    AlarmError,
    DeviceError,
    LinkError,
    NotArrivedError,
    NotSentError,
    ProtocolError,
    RefusedError,
)
from catseye.drivers.roles.pose import Pose

_DUPLICATE_DEFINITION = 4350


class JointMotion:
    """Moves the joints over the first connection.

    Args:
        still_polls: equal positions in a row that say that a motion which was started has ended or never began.
        take_right: takes the operation right unless it is held.
        account_for: is called with the target of a motion whose answer was lost, and how.
        reset_alarm: resets the active alarm.

    Attributes:
        variable: of the controller that carries targets; set before the first motion.
        waits: the first connection waits for the end of a motion.
    """

    def __init__(
        self,
        connections: Connections,
        clock: Clock,
        settings: MelfaSettings,
        *,
        still_polls: int,
        take_right: Callable[[], Awaitable[None]],
        account_for: Callable[[Pose, DeviceError], Awaitable[None]],
        reset_alarm: Callable[[], Awaitable[None]],
    ) -> None:
        self._connections = connections
        self._main = connections.main
        self._clock = clock
        self._settings = settings
        self._still_polls = still_polls
        self._take_right = take_right
        self._account_for = account_for
        self._reset_alarm = reset_alarm
        self._declared = False
        self.variable = ""
        self.waits = False

    def forget(self) -> None:
        """Declare the variable again before the next motion: a new connection does not know it."""
        self._declared = False

    async def go(self, target: Pose, permit: Callable[[], None]) -> None:
        """Move to the target; return when the robot stands there. The motion is sent once.

        Args:
            target: J1 deg, J2 deg, J3 mm, J4 deg.
            permit: is asked right before the motion is written; what it raises keeps it from being sent.

        Raises:
            DeviceError: as for `MelfaR3.move_joints`.
        """
        # An answer to the assignment that came twice keeps the motion back, and nothing moves.
        await sent_once(
            partial(self._main.link.repeated, partial(self._prepare, target)),
            partial(self._go, target, permit),
        )

    async def _prepare(self, target: Pose) -> None:
        """Give the controller the target: on the very connection from which the motion takes it."""
        # A link in step shows only when something is sent that it has come out of step: then this is done again.
        if self._main.link.doubt or not self._declared:
            await self._main.link.ensure()
        # It may have been refused while the link was opened again, and the override not been lowered then.
        await self._take_right()
        await self._declare()
        await self._main.command(
            f"EXEC{assignment(self.variable, target)}", repeat=Repeat.BOUND, permit=self._require_declared
        )

    def _require_declared(self) -> None:
        """Keep back what builds on a connection that a question of somebody else has opened again meanwhile.

        Raises:
            NotSentError: nothing was sent.
        """
        if not self._declared:
            raise NotSentError(f"{self._main.where}: the link was opened again meanwhile: nothing was sent")

    def _bound(self, permit: Callable[[], None]) -> Callable[[], None]:
        def bound() -> None:
            # A stop is the reason that counts.
            permit()
            self._require_declared()

        return bound

    async def _declare(self) -> None:
        """Declare the joint variable once a connection; a definition that is there already is used."""
        if self._declared:
            return
        try:
            await self._main.command(f"EXECDEF JNT {self.variable}", repeat=Repeat.BOUND)
        except RefusedError as exc:
            if exc.number != _DUPLICATE_DEFINITION:
                raise
            if isinstance(exc, AlarmError):
                await self._reset_alarm()
        self._declared = True

    async def _go(self, target: Pose, permit: Callable[[], None]) -> None:
        try:
            if self._settings.motion == "exec2" and self._connections.has_side:
                reached = await self._waited_for(target, permit)
            else:
                reached = await self._polled(target, permit)
        except NotSentError:
            raise
        except (LinkError, ProtocolError) as lost:
            await self._account_for(target, lost)
            return
        if off := off_target(reached, target, self._settings):
            await self._main.raise_alarm("MOV")
            # STOP may have been answered before the motion that it ended.
            permit()
            raise NotArrivedError(f"{self._main.where}: the motion is over, but {off}: {LOOK_WHY}")

    async def _waited_for(self, target: Pose, permit: Callable[[], None]) -> Pose:
        """Move and wait for the answer, which comes at the end of the motion; return where the robot stands."""
        motion = self._main.command(
            f"EXEC2=MOV {self.variable}",
            timeout_s=self._settings.move_timeout_s,
            repeat=Repeat.BOUND,
            permit=self._bound(permit),
        )
        self.waits = True
        try:
            await answered(motion, self._connections.side)
        finally:
            self.waits = False
        with asking_under_way():
            reached, state = await self._main.joints(), await self._main.state()
        require_unlocked(self._main.where, state)
        if not off_target(reached, target, self._settings):
            return reached
        # The answer may have been a late double of the one before: an arm that is yet to arrive is waited for.
        return await self._at_rest(target)

    async def _polled(self, target: Pose, permit: Callable[[], None]) -> Pose:
        """Start the motion and look until the robot stands; return where."""
        await self._main.command(f"EXECMOV {self.variable}", repeat=Repeat.BOUND, permit=self._bound(permit))
        return await self._at_rest(target)

    async def _at_rest(self, target: Pose) -> Pose:
        """Look until the robot stands; return where."""
        return await standstill(
            self._main,
            self._clock,
            self._settings,
            timeout_s=self._settings.move_timeout_s,
            still_polls=self._still_polls,
            target=target,
        )
