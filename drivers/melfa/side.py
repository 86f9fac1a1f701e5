"""Questions while the arm moves: on the status connection, on the stop connection as long as that one is lost."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import TypeVar

from catseye.drivers.melfa.codec import State
from catseye.drivers.melfa.session import Session
from catseye.drivers.roles.errors import DeviceError, LinkError, ProtocolError
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotStatus

T = TypeVar("T")

QUESTIONS = "questions during motion"
"""What the connection is for, in texts."""

PATIENCE_S = 1.0
"""For an answer on a connection besides which there is another, real s."""

HEAL_PERIOD_S = 1.0
"""Between two attempts to open a lost connection again, real s."""


class Side:
    """Asks a connection that no motion blocks.

    A connection that does not answer in time is put aside and healed by a task of its own, so that neither the next
    question nor a STOP waits for it.

    Args:
        other: where to ask as long as the first one is lost; None: there is no other.
    """

    def __init__(self, session: Session, other: Session | None = None) -> None:
        self._session = session
        self._other = other
        self._healing: asyncio.Task[None] | None = None
        self._note = ""
        self._closed = False

    @property
    def where(self) -> str:
        """Device and endpoint, for texts."""
        return self._session.where

    @property
    def note(self) -> str:
        """What an operator should know of a connection that is lost; empty when it is there."""
        return self._note

    async def close(self) -> None:
        """Give up healing for good; may be called any number of times."""
        self._closed = True
        healing, self._healing = self._healing, None
        self._note = ""
        if healing is not None:
            healing.cancel()
            await asyncio.wait({healing})

    async def state(self) -> State:
        """Ask STATE; see `Session`, as for the others."""
        return await self._ask(Session.state)

    async def status(self) -> RobotStatus:
        """Ask STATE, and ERROR too when an alarm is flagged."""
        return await self._ask(Session.status)

    async def joints(self) -> Pose:
        """Ask JPOSF."""
        return await self._ask(Session.joints)

    async def _ask(self, question: Callable[[Session], Awaitable[T]]) -> T:
        if self._other is None:
            return await question(self._session)
        if self._healing is None:
            try:
                async with asyncio.timeout(PATIENCE_S):
                    return await question(self._session)
            except (LinkError, ProtocolError, TimeoutError) as exc:
                self._put_aside(str(exc) or f"no answer within {PATIENCE_S:g} s")
        return await question(self._other)

    def _put_aside(self, why: str) -> None:
        if self._closed:
            # A question that was in flight failed with its connection.
            return
        self._note = (
            f"the connection for {QUESTIONS} is lost, the stop connection serves them meanwhile ({why})"
        )
        if self._healing is None:
            self._healing = asyncio.create_task(self._heal())

    async def _heal(self) -> None:
        while True:
            await asyncio.sleep(HEAL_PERIOD_S)
            try:
                await self._session.link.ensure()
            except DeviceError as exc:
                self._put_aside(str(exc))
            else:
                self._healing, self._note = None, ""
                return
