"""The door of a cell, asked again and again: as fast while the arm moves as while it stands."""

import asyncio
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from typing import Final

from catseye.app.engine.waiting import cancel
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.errors import DeviceError
from catseye.drivers.roles.io import Io

TICK_S: Final = 0.06
"""Between two questions, real s."""

_SILENT_TICKS = 5
"""Without a valid answer for 0.3 s the door counts as open. Ticks and not the time are counted: while the event loop
is held up nothing is sent to the robot either, and an answer that waits in the link's buffer is no silence."""

_TRIES = 2
"""A single lost answer stops no arm: the question is asked again before the silence is over."""

_OPEN = "the door is open: no motion; close it when nobody is inside"
_SILENT = "the door interlock does not answer, which counts as open: no motion; check [io]"
_UNSEEN = "the door has not been looked at yet: no motion"


class DoorWatch:
    """Asks for the door until cancelled; no question delays anything else.

    Args:
        io: block with the interlock; its own time-out ends a question.
        on_trouble: called with each look at which the door forbids motion, and with each tick of its silence.
        speed: seconds of the clock in one real second: the door is a real device on a real link.

    Attributes:
        trouble: why the door forbids motion, as it was seen last; None while it is closed.
        just_opened: it forbids motion since the latest look, and permitted it before.
    """

    def __init__(self, io: Io, clock: Clock, on_trouble: Callable[[str], None], speed: float = 1.0) -> None:
        self.trouble: str | None = _UNSEEN
        self.just_opened = False
        self._io = io
        self._clock = clock
        self._on_trouble = on_trouble
        self._tick_s = TICK_S * speed
        self._silent_ticks = 0
        self._failure = "no answer"

    async def watch(self) -> None:
        """Ask until cancelled."""
        question = asyncio.create_task(self.look())
        try:
            while True:
                await self._clock.sleep(self._tick_s)
                self._silent_ticks += 1
                if self._silent_ticks >= _SILENT_TICKS:
                    self._found(_SILENT, self._failure)
                if question.done():
                    question.result()
                    question = asyncio.create_task(self.look())
        finally:
            await cancel(question)

    @asynccontextmanager
    async def watching(self, on_ended: Callable[[str], None]) -> AsyncIterator[None]:
        """Watch meanwhile; the door has been looked at when this begins.

        Args:
            on_ended: called when the watch ends before that, by a fault of the program or cancelled by others, with
                what has happened: nothing may go on unwatched.
        """

        def ended(watch: "asyncio.Task[None]") -> None:
            error = None if watch.cancelled() else watch.exception()
            self.trouble = f"the door is watched no more: {error or 'the watch was cancelled'}"
            on_ended(self.trouble)

        await self.look()
        watch = asyncio.create_task(self.watch())
        watch.add_done_callback(ended)
        try:
            yield
        finally:
            watch.remove_done_callback(ended)
            await cancel(watch)

    async def look(self) -> None:
        """Ask once, and once more when no valid answer comes."""
        for _ in range(_TRIES):
            try:
                closed = await self._io.door_closed()
            except DeviceError as error:
                self._failure = str(error)
                continue
            self._silent_ticks = 0
            self._found(None if closed else _OPEN)
            return

    def _found(self, trouble: str | None, detail: str = "") -> None:
        self.just_opened = self.trouble is None and trouble is not None
        # The detail differs with each failure while the trouble is the same: nobody is called with it.
        self.trouble = f"{trouble}: {detail}" if detail else trouble
        if trouble is not None:
            self._on_trouble(trouble)
