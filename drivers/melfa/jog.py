"""Jog with two dead-men: the controller's own of about 140 ms, and the caller, who has to feed (sheet, section 1.9).

A telegram goes out well within the controller's time as long as the caller fed recently. Whatever ends the feeding
(the caller, an error, a cancellation, this program's end), the telegrams stay away and the robot stops by itself;
STOP follows on top.
"""

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable, Mapping
from contextlib import asynccontextmanager

from catseye.drivers.links.cancelling import uninterrupted
from catseye.drivers.links.healing import Repeat
from catseye.drivers.melfa.motion import JOINT_NAMES
from catseye.drivers.melfa.session import Session
from catseye.drivers.roles.errors import DeviceError, RefusedError
from catseye.drivers.roles.robot import JogDirection

PERIOD_S = 0.05
"""Between two telegrams, real s."""

DEAD_MAN_S = 0.14
"""After which the controller stops a jog that is not repeated, s."""

FED_FOR_S = 0.2
"""How long one feeding lasts, real s."""


class Jog:
    """A jog under way; made by `jogging`.

    Args:
        require_no_stop: refuses once a stop has begun.
    """

    def __init__(self, session: Session, command: str, require_no_stop: Callable[[], None]) -> None:
        self._session = session
        self._require_no_stop = require_no_stop
        self._command = command
        self._loop = asyncio.get_running_loop()
        self._fed_until_s = 0.0
        self._fed = asyncio.Event()
        self._over = False

    def feed(self) -> None:
        """Keep moving for another 0.2 s; has to be called again before they are over."""
        self._fed_until_s = self._loop.time() + FED_FOR_S
        self._fed.set()

    def end(self) -> None:
        """Send no further telegram."""
        self._over = True
        self._fed.set()

    async def repeat(self) -> None:
        """Send telegrams while fed, until the end.

        Raises:
            DeviceError: one was refused or not answered in time, or a stop has begun.
        """
        while not self._over:
            await self._fed.wait()
            self._fed.clear()
            while (begun_s := self._loop.time()) < self._fed_until_s and not self._over:
                # A late answer is worth nothing: the robot has stopped by then.
                await self._session.command(
                    self._command, timeout_s=DEAD_MAN_S, repeat=Repeat.BOUND, permit=self._require_going_on
                )
                await asyncio.sleep(max(0.0, begun_s + PERIOD_S - self._loop.time()))

    def _require_going_on(self) -> None:
        """Keep a telegram that has waited for its turn from being sent behind a STOP.

        Raises:
            RefusedError: a stop has begun, or the jog is over.
        """
        self._require_no_stop()
        if self._over:
            raise RefusedError(f"{self._session.where}: the jog is over", 0)


@asynccontextmanager
async def jogging(
    session: Session,
    directions: Mapping[str, JogDirection],
    stop: Callable[[], Awaitable[None]],
    require_no_stop: Callable[[], None],
) -> AsyncIterator[Jog]:
    """Jog joints while the caller feeds; at the end, however it comes, the robot is stopped.

    Args:
        directions: joint names with -1 or 1.
        stop: stops the robot and waits for its standstill.
        require_no_stop: refuses once a stop has begun.

    Raises:
        ValueError: there is no such joint.
        DeviceError: a telegram was refused or not answered in time, or a stop has begun; the robot has been stopped.
    """
    jog = Jog(session, telegram(directions), require_no_stop)
    telegrams = asyncio.create_task(jog.repeat())
    body = asyncio.current_task()
    failed: list[DeviceError] = []

    def look(task: asyncio.Task[None]) -> None:
        error = None if task.cancelled() else task.exception()
        if isinstance(error, DeviceError) and body is not None:
            failed.append(error)
            body.cancel()

    telegrams.add_done_callback(look)
    try:
        yield jog
    except asyncio.CancelledError:
        # A refused telegram ends the body this way; anybody else's cancellation goes on.
        if not failed or body is None or body.uncancel() > 0:
            raise
    finally:
        telegrams.remove_done_callback(look)
        jog.end()
        await uninterrupted(_end(telegrams, stop))
    if failed:
        raise failed[0]


async def _end(telegrams: asyncio.Task[None], stop: Callable[[], Awaitable[None]]) -> None:
    try:
        # Past a telegram that waits for its answer: it keeps its turn, so that the link stays in step.
        await stop()
    finally:
        await asyncio.wait({telegrams}, timeout=DEAD_MAN_S)
        telegrams.cancel()
        # What the last telegram met is of no interest any more.
        await asyncio.gather(telegrams, return_exceptions=True)


def telegram(directions: Mapping[str, JogDirection]) -> str:
    """Return the JOG command of joints: mode 00, axes as bits, no inching.

    Raises:
        ValueError: there is no such joint.
    """
    if not directions or not set(directions) <= set(JOINT_NAMES):
        raise ValueError(f"joints to jog are some of {', '.join(JOINT_NAMES)}, got {', '.join(directions)}")
    bits = {name: 1 << n for n, name in enumerate(JOINT_NAMES)}
    minus, plus = (sum(bits[name] for name, way in directions.items() if way == sign) for sign in (-1, 1))
    return f"JOG00;00;{minus:02X};{plus:02X};00"
