"""`[hooks]` of the cell file: a command that is given events of a run, bounded in time; nothing waits for it."""

import asyncio
import logging
import os
import signal
import subprocess
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from typing import IO, Final, Protocol, cast

from catseye.app.cell.model import HookEvent
from catseye.app.cell.model import Hooks as HooksSection
from catseye.app.engine.announcer import Publish
from catseye.app.engine.handle import RunHandle
from catseye.app.engine.waiting import cancel, uncancelled, within
from catseye.app.protocol.events import encode_event
from catseye.app.protocol.run_events import ErrorReported, PromptAsked, RunEnded, RunEvent, StateChanged
from catseye.app.protocol.state import ControlState
from catseye.app.service.aside import aside
from catseye.drivers.roles.clock import Clock

_log = logging.getLogger(__name__)

LIMIT_S: Final = 10.0
"""A command that takes longer is ended, real s."""

GRACE_S: Final = 2.0
"""From SIGTERM to SIGKILL."""

END_S: Final = LIMIT_S + 2.0 * GRACE_S
"""So long the end of the process waits for those under way, which end within that unless they cannot even begin."""

MOST: Final = 4
"""Commands under way at a time."""

_POLL_S: Final = 0.05

_ALARMS: Final = frozenset({ControlState.SUSPENDING, ControlState.ABORTING})


class HookProcess(Protocol):
    """A command under way."""

    def poll(self) -> int | None:
        """Return its exit code; None while it runs."""
        ...

    def deliver(self, number: int) -> None:
        """Send a signal to it and to what it has started."""
        ...


class CommandProcess:
    """A process in a session of its own: keys and signals of a terminal do not reach it.

    Args:
        command: words; no shell reads them.
        line: for its stdin.

    Raises:
        OSError: it cannot be started.
    """

    def __init__(self, command: Sequence[str], line: bytes) -> None:
        nothing = subprocess.DEVNULL
        self._process = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=nothing, stderr=nothing, start_new_session=True
        )
        # A command may leave its stdin unread for as long as it likes.
        stdin = cast(IO[bytes], self._process.stdin)
        threading.Thread(target=_feed, args=(stdin, line), daemon=True).start()

    def poll(self) -> int | None:
        """Return its exit code; None while it runs."""
        return self._process.poll()

    def deliver(self, number: int) -> None:
        """Send a signal to it and to what it has started."""
        with suppress(ProcessLookupError):
            os.killpg(self._process.pid, number)


def _feed(stdin: IO[bytes], line: bytes) -> None:
    with suppress(OSError), stdin:
        stdin.write(line)


StartHook = Callable[[Sequence[str], bytes], HookProcess]
"""Starts a command with a line on its stdin, however long that takes; raises OSError."""


class Hooks:
    """Commands under way in this process.

    Args:
        clock: real time.
        start: starts one.

    Attributes:
        dropped: events that were not passed on, since too many commands were under way.
    """

    def __init__(self, clock: Clock, start: StartHook = CommandProcess) -> None:
        self.dropped = 0
        self._clock = clock
        self._start = start
        self._under_way: set[asyncio.Task[None]] = set()

    def of_run(self, section: HooksSection) -> "RunHooks":
        """Return those of a run."""
        return RunHooks(self, section)

    def begin(self, command: Sequence[str], line: bytes, failed: Callable[[str], None]) -> None:
        """Have a command do its work beside everything else.

        Args:
            line: for its stdin.
            failed: receives later what went wrong.
        """
        if len(self._under_way) >= MOST:
            self.dropped += 1
            text = f"{MOST} commands are under way, and this event is not passed on"
            asyncio.get_running_loop().call_soon(failed, text)
            return
        task = asyncio.create_task(self._do(command, line, failed))
        self._under_way.add(task)
        task.add_done_callback(self._under_way.discard)

    async def end(self) -> None:
        """Give those under way some time, then end them."""
        under_way = set(self._under_way)
        try:
            if under_way:
                await within(self._clock, END_S, _all_ended(under_way))
        except TimeoutError:
            _log.warning("[hooks] %d commands are ended: they take too long", len(self._under_way))
        finally:
            await cancel(*under_way)
        if self.dropped:
            _log.warning("[hooks] %d events were not passed on", self.dropped)

    async def _do(self, command: Sequence[str], line: bytes, failed: Callable[[str], None]) -> None:
        try:
            process = await aside(partial(self._start, command, line))
        except OSError as error:
            failed(f"{command[0]} cannot be started: {error.strerror or error}")
            return
        try:
            code = await self._ended(process, LIMIT_S)
            if code is None:
                process.deliver(signal.SIGTERM)
                failed(f"{command[0]} took longer than {LIMIT_S:g} s and is ended")
                await self._ended(process, GRACE_S)
            elif code:
                failed(f"{command[0]} ended with code {code}")
        finally:
            if process.poll() is None:
                process.deliver(signal.SIGKILL)
                await uncancelled(self._ended(process, GRACE_S))

    async def _ended(self, process: HookProcess, limit_s: float) -> int | None:
        """Return the exit code; None if it runs on after so long."""
        end_s = self._clock.monotonic_s() + limit_s
        while (code := process.poll()) is None and self._clock.monotonic_s() < end_s:
            await self._clock.sleep(_POLL_S)
        return code


async def _all_ended(tasks: "set[asyncio.Task[None]]") -> None:
    await asyncio.wait(tasks)


class RunHooks:
    """Passes the events of one run that the cell file names on to its command."""

    def __init__(self, hooks: Hooks, section: HooksSection) -> None:
        self._hooks = hooks
        self._section = section
        self._handle: RunHandle | None = None
        self._told = False

    @contextmanager
    def attending(self, handle: RunHandle) -> Iterator[None]:
        """Let failures be warnings of a run while its record is open."""
        self._handle = handle
        try:
            yield
        finally:
            self._handle = None

    def before(self, publish: Publish) -> Publish:
        """Return what takes the events of the run here first, and then there."""

        def both(event: RunEvent) -> None:
            self._take(event)
            publish(event)

        return both

    def _take(self, event: RunEvent) -> None:
        if isinstance(event, RunEnded):
            # Its record is sealed: nothing is the run's warning any more.
            self._handle = None
        if hook_event(event) in self._section.on:
            self._hooks.begin(self._section.command, encode_event(event), self._failed)

    def _failed(self, text: str) -> None:
        if self._told:
            return
        self._told = True
        text = f"[hooks] {text}; the run does not depend on it, and further failures are not reported"
        if self._handle is None:
            _log.warning("%s", text)
        else:
            self._handle.warn(text)


def hook_event(event: RunEvent) -> HookEvent | None:
    """Return what an event is called in `[hooks] on`; None for one that no hook is for."""
    match event:
        case RunEnded():
            return "run-ended"
        case PromptAsked():
            return "prompt"
        case ErrorReported():
            return "alarm"
        case StateChanged() if event.state in _ALARMS:
            return "alarm"
        case _:
            return None
