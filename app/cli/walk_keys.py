"""The terminal of a walk: the space bar, held, keeps the arm going; questions are answered by lines as ever."""

import asyncio
import signal
import termios
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Final

from catseye.app.engine.announcer import Publish
from catseye.app.protocol.run_events import PromptAnswered, PromptAsked, RunEvent
from catseye.app.service.dead_man import DeadMan
from catseye.app.service.walk.feed import Feed
from catseye.drivers.roles.clock import Clock

HINT: Final = (
    "hold the space bar to walk; let it go and the arm is stopped. h hold · g go on · s stop · a abort, without "
    "Enter. This is not an enabling device: keep a hand on the real emergency stop"
)

_KEY: Final = " "
_COMMANDS: Final = "hgsa"
_TICK_S = 0.05


class WalkKeys:
    """Takes single keys while no question is open.

    Args:
        feed: keeps the arm going.
        command: takes h, g, s or a.
        clock: real time.
    """

    def __init__(self, descriptor: int, feed: Feed, command: Callable[[str], None], clock: Clock) -> None:
        self._descriptor = descriptor
        self._feed = feed
        self._command = command
        self._clock = clock
        self._key: DeadMan[str] = DeadMan()
        self._asked = False
        self._lines = termios.tcgetattr(descriptor)

    @contextmanager
    def held(self) -> Iterator[None]:
        """Feed while the space bar repeats; the terminal is as before when this ends."""
        # A process that was sent to the background may still give the terminal back.
        before = signal.signal(signal.SIGTTOU, signal.SIG_IGN)
        feeding = asyncio.get_running_loop().create_task(self._feeding())
        self._single_keys()
        try:
            yield
        finally:
            feeding.cancel()
            self._whole_lines()
            signal.signal(signal.SIGTTOU, before)

    def before(self, publish: Publish) -> Publish:
        """Return what takes the events of the run: lines are typed as long as a question is open."""

        def hear(event: RunEvent) -> None:
            if isinstance(event, PromptAsked):
                self._asked = True
                self._let_go()
                self._whole_lines()
            elif isinstance(event, PromptAnswered):
                self._asked = False
                self._single_keys()
            publish(event)

        return hear

    def sort(self, chunk: bytes) -> bytes:
        """Take keys; return what belongs to lines."""
        if self._asked:
            return chunk
        for key in chunk.decode(errors="replace"):
            if key == _KEY:
                self._key.press(key, self._clock.monotonic_s())
            elif key.lower() in _COMMANDS:
                self._let_go()
                self._command(key.lower())
            else:
                self._let_go()
        return b""

    def _let_go(self) -> None:
        self._key.let_go()
        self._feed.let_go()

    async def _feeding(self) -> None:
        while True:
            if self._key.held(self._clock.monotonic_s()) is not None:
                self._feed.feed()
            await self._clock.sleep(_TICK_S)

    def _single_keys(self) -> None:
        # Ctrl-C stays a signal: the ladder of every other run.
        tty.setcbreak(self._descriptor, termios.TCSANOW)

    def _whole_lines(self) -> None:
        termios.tcsetattr(self._descriptor, termios.TCSANOW, self._lines)
