"""The emulated bench of an engine: a process that lives as long as the engine does, whoever has started it."""

import asyncio
from collections.abc import Callable
from pathlib import Path
from typing import Final

from catseye.app.engine.waiting import cancel
from catseye.app.errors import CatseyeError
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.answers import Answer
from catseye.app.protocol.events import AnyEvent
from catseye.app.protocol.run_events import ErrorReported
from catseye.app.service.emulation import emulator_process
from catseye.app.service.errors import RefusedError, refusal_of

SEED: Final = 2
"""Of the bench that somebody asks for by a key."""


class OwnedEmulators:
    """Emulators of every device of a cell file.

    Args:
        cell: the cell file.
        announce: sends every client an event.
        changed: called when they answer, and when they have ended.
    """

    def __init__(self, cell: Path, announce: Callable[[AnyEvent], None], changed: Callable[[], None]) -> None:
        self._cell = cell
        self._announce = announce
        self._changed = changed
        self._task: asyncio.Task[None] | None = None
        self._ready: asyncio.Future[Answer] | None = None
        self._speed = 1.0

    @property
    def speed(self) -> float | None:
        """Bench seconds in one real second; None where they do not answer now."""
        return self._speed if self._ready is not None and self._ready.done() and not self._ended else None

    def begin(self, speed: float) -> "asyncio.Future[Answer]":
        """Start them, if they do not run; the result is there when they answer.

        Args:
            speed: bench seconds in one real second.

        Raises:
            RefusedError: they run at another speed.
        """
        if self._ready is not None and not self._ended and speed != self._speed:
            raise RefusedError(
                f"the emulated bench runs at {self._speed:g} times real speed: keep to that, or quit, which ends it"
            )
        if self._ready is None or self._ended:
            self._speed = speed
            self._ready = asyncio.get_running_loop().create_future()
            self._task = asyncio.create_task(self._serve(speed, self._ready))
        return asyncio.shield(self._ready)

    async def end(self) -> None:
        """End them."""
        if self._task is not None:
            await cancel(self._task)

    @property
    def _ended(self) -> bool:
        return self._task is None or self._task.done()

    async def _serve(self, speed: float, ready: "asyncio.Future[Answer]") -> None:
        try:
            async with emulator_process(self._cell, speed, SEED, None) as emulators:
                ready.set_result(Answer())
                self._changed()
                code = await emulators.process.wait()
                text = f"the emulated bench has ended with code {code}: start it again (F10)"
                self._announce(ErrorReported(text=text, exit_code=int(ExitCode.DEVICE)))
        except CatseyeError as error:
            ready.set_exception(refusal_of(error))
        except (OSError, ValueError) as error:
            ready.set_exception(RefusedError(f"the emulators did not start: {error}"))
        finally:
            ready.cancel()
            asyncio.get_running_loop().call_soon(self._changed)
