"""STOP: written on every connection at once, repeated until standstill is seen, or reported as unconfirmed."""

import asyncio

from catseye.drivers.links.healing import Repeat
from catseye.drivers.melfa import codec
from catseye.drivers.melfa.connections import Connections
from catseye.drivers.melfa.motion import STILL_POLLS, standstill
from catseye.drivers.melfa.session import Session
from catseye.drivers.melfa.settings import MelfaSettings
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError, LinkError

PERIOD_S = 0.1
"""Between two STOPs on one connection, real s."""

TAKEN_WITHIN_S = 0.8
"""After which a STOP that no connection takes is reported, real s."""

_INSISTS = 10
"""STOPs on every connection, a period apart, when nobody can see whether one was heard."""

_PRESS = "PRESS THE EMERGENCY STOP if the robot moves"


class Halt:
    """One stop of the robot.

    STOP goes past whatever is in flight, so the connections are out of step afterwards; those that answer questions
    are healed, asked to stop once more and then asked where the arm is. A connection that floods is not read: it is
    written to until the stop is over, and closed then.
    """

    def __init__(self, connections: Connections, clock: Clock, settings: MelfaSettings) -> None:
        self._connections = connections
        self._clock = clock
        self._settings = settings
        self._taken = asyncio.Event()
        self._refusals: dict[Session, str] = {}

    def send(self) -> None:
        """Hand STOP to the operating system on every connection; waits for nothing."""
        for session in self._connections.all:
            self._write(session)

    async def confirm(self) -> None:
        """Repeat STOP until the arm is seen to stand.

        Raises:
            LinkError: no connection took STOP, or the standstill is not confirmed: use the emergency stop.
        """
        looks = {asyncio.create_task(self._look(session)) for session in self._connections.askers}
        repeating = asyncio.create_task(self._repeat())
        try:
            await self._require_taken()
            await self._require_seen(looks)
        finally:
            for task in (*looks, repeating):
                task.cancel()
            await asyncio.gather(*looks, repeating, return_exceptions=True)
            for session in self._connections.all:
                await session.link.end_flood()

    def _write(self, session: Session) -> None:
        try:
            session.send_urgent("STOP")
        except LinkError as exc:
            self._refusals[session] = str(exc)
        else:
            self._taken.set()

    async def _repeat(self) -> None:
        """Write STOP again where no look does; as long as none was taken, on a link that was just opened too."""
        while True:
            await asyncio.sleep(PERIOD_S)
            for session in self._connections.all:
                looks = session in self._connections.askers and not session.link.floods
                if not looks or not self._taken.is_set():
                    self._write(session)

    async def _look(self, session: Session) -> None:
        """Stop and look on a connection that is healed for it."""
        await standstill(
            session,
            self._clock,
            self._settings,
            timeout_s=self._settings.stop_timeout_s,
            still_polls=STILL_POLLS,
            before_look=_Again(session, self._taken).ask,
        )

    async def _require_taken(self) -> None:
        try:
            async with asyncio.timeout(TAKEN_WITHIN_S):
                await self._taken.wait()
        except TimeoutError:
            raise LinkError(
                f"{self._connections.main.where}: STOP could not be sent on any connection: {_PRESS} "
                f"({'; '.join(self._refusals.values())})"
            ) from None

    async def _require_seen(self, looks: set["asyncio.Task[None]"]) -> None:
        failures: list[str] = []
        pending = looks
        while pending:
            done, pending = await asyncio.wait(pending, return_when=asyncio.FIRST_COMPLETED)
            for task in done:
                error = task.exception()
                if error is None:
                    return
                if not isinstance(error, DeviceError):
                    raise error
                failures.append(str(error))
        await self._insist()
        raise LinkError(
            f"{self._connections.main.where}: STOP was sent, but the standstill is not confirmed: {_PRESS} "
            f"({'; '.join(failures)})"
        )

    async def _insist(self) -> None:
        """Write STOP for a while longer: a connection that is closed now may take an unread one along."""
        for _ in range(_INSISTS):
            self.send()
            await asyncio.sleep(PERIOD_S)


class _Again:
    """Asks STOP before a look when the last one is long enough ago.

    Args:
        taken: is set when the controller has answered.
    """

    def __init__(self, session: Session, taken: asyncio.Event) -> None:
        self._session = session
        self._taken = taken
        self._due_s = 0.0

    async def ask(self) -> None:
        """Stop the arm, unless that was done just now."""
        loop = asyncio.get_running_loop()
        if loop.time() < self._due_s:
            return
        await self._session.ask("STOP", codec.bare, repeat=Repeat.HARMLESS)
        self._taken.set()
        self._due_s = loop.time() + PERIOD_S
