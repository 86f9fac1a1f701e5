"""Moving the arm by hand: steps and holds as requests to the engine, one at a time."""

import asyncio
from collections.abc import Callable, Coroutine, Sequence
from dataclasses import dataclass
from typing import Any, Final, Literal

from catseye.app.service.dead_man import DeadMan
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui.link import Link
from catseye.app.tui.requests import Requests

Way = Literal[-1, 1]

FEED_S: Final = 0.05
"""Between two signs that a key is held, or that this program lives; the engine waits 0.2 s and 0.5 s for them."""


@dataclass(frozen=True)
class Step:
    """One step of a joint, or of the beam.

    Attributes:
        joint: what moves, as the engine names it.
        by: deg; mm at the aim for the beam.
        aim: reflector that the beam is kept on, or measured at.
    """

    joint: str
    by: float
    aim: str | None = None


class JogClient:
    """Asks the engine for motions by hand.

    Args:
        now_s: monotonic time, s.
        failed: called with why something did not move.
        sleep: waits, real s.
    """

    def __init__(
        self,
        link: Link,
        now_s: Callable[[], float],
        failed: Callable[[str], None],
        sleep: Callable[[float], Coroutine[Any, Any, None]] = asyncio.sleep,
    ) -> None:
        self._link = link
        self._requests = Requests(link, failed)
        self._now_s = now_s
        self._failed = failed
        self._sleep = sleep
        self._key: DeadMan[tuple[str, Way]] = DeadMan()
        self._motion: asyncio.Task[None] | None = None

    @property
    def busy(self) -> bool:
        """A step or a hold is under way."""
        return self._motion is not None and not self._motion.done()

    def step(self, *steps: Step) -> bool:
        """Begin steps, one after the other; return False when something is under way already."""
        if self.busy:
            return False
        self._requests.refused = False
        self._motion = asyncio.create_task(self._take(steps))
        return True

    def press(self, joint: str, way: Way) -> None:
        """Take a press of a key that moves a joint as long as it is held."""
        now_s = self._now_s()
        self._key.press((joint, way), now_s)
        if not self.busy and self._key.held(now_s) is not None:
            self._requests.refused = False
            self._motion = asyncio.create_task(self._keep_moving(joint))

    def let_go(self) -> None:
        """End whatever is under way; the arm stops now."""
        self._key.let_go()
        if self._motion is not None and self.busy:
            self._motion.cancel()

    async def _keep_moving(self, joint: str) -> None:
        """Feed the engine while a key is held; however this ends, the arm is stopped."""
        from catseye.app.protocol.requests import JogHold

        try:
            while (held := self._key.held(self._now_s())) is not None and not self._requests.refused:
                joint, way = held
                if self._requests.unanswered:
                    self._failed("the engine no longer answers: the arm stops by itself; look at it")
                    break
                self._requests.send(JogHold(joint=joint, direction=way))
                await self._sleep(FEED_S)
        finally:
            if self._key.held(self._now_s()) is not None:
                # It ended although the key is held: the key has to be let go first.
                self._key.let_go()
            self._requests.send(JogHold(joint=joint, direction=0))

    async def _take(self, steps: Sequence[Step]) -> None:
        from catseye.app.protocol.requests import JogHold, JogStep

        alive = asyncio.create_task(self._show_life())
        try:
            for step in steps:
                await self._link.request(JogStep(joint=step.joint, by=step.by, aim=step.aim))
        except (RefusedError, ServiceError) as error:
            self._failed(str(error))
        except asyncio.CancelledError:
            self._requests.send(JogHold(joint=steps[0].joint, direction=0))
            raise
        finally:
            alive.cancel()

    async def _show_life(self) -> None:
        """Ping while a step is under way: the engine stops the arm of a client that is silent."""
        from catseye.app.protocol.requests import Plain

        while not self._requests.unanswered:
            await self._sleep(FEED_S)
            self._requests.send(Plain(op="ping"))
