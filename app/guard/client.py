"""The guard of one arm as the engine uses it: ownership, connections, heartbeat, and the check before each motion."""

import asyncio
import contextlib
import os
import re
import stat
import time
from collections.abc import AsyncIterator, Callable, Sequence
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Final

from catseye.app.errors import SafetyError
from catseye.app.guard.guard import FROZEN, FROZEN_S
from catseye.app.guard.lock import Owner, OwnerLock
from catseye.app.guard.process import GuardProcess
from catseye.drivers.links.guarding import GuardError

LOG_NAME: Final = "guard.log"
"""In the folder of all runs: what guards have done."""

BEAT_S: Final = 0.1
_FRESH_S = 0.3
_ANSWER_S = 2.0
_MOST_LOG_BYTES = 1 << 20
_NO_WORD = re.compile(r"[^!-~]+")


class ArmGuard:
    """Guards one arm: its lock, its process, and what the driver asks of both.

    It fits `catseye.drivers.links.guarding.LinkGuard`.

    Attributes:
        on_stop: is called with the reason when the guard has stopped the arm, or has died while it moved.
        stopped: why nothing moves before an operator has acknowledged that; empty when the guard has not stopped it.
    """

    def __init__(self, endpoint: str) -> None:
        self.on_stop: Callable[[str], None] = lambda _reason: None
        self._endpoint = endpoint
        self._links: dict[str, tuple[int, bytes]] = {}
        self._lock: OwnerLock | None = None
        self._log: int | None = None
        self._process: GuardProcess | None = None
        self._starting = asyncio.Lock()
        self._beat: asyncio.TimerHandle | None = None
        self._beat_due_s = 0.0
        self._motions = 0
        self._said_moving = False
        self.stopped = ""
        self._released: set[str] = set()

    async def hold(self, who: str, folder: Path, *, simulated: bool) -> list[str]:
        """Become the arm's owner and have it guarded; return what has become of it since it was given back last.

        Args:
            who: what moves the arm, such as the name of a run.
            folder: of all runs; the guard's log is there.

        Raises:
            ArmInUseError: another program owns it.
            SafetyError: the robot's driver hands no connection to the guard and the arm is real.
            GuardError: the guard does not start.
        """
        if not simulated and not self._links:
            raise SafetyError(
                f"the driver of the robot at {self._endpoint} hands no connection to the guard: if this program died "
                "nobody would stop the arm; use a driver that does, see docs/write-a-driver.md"
            )
        self._lock = await OwnerLock.taken(self._endpoint, Owner.here(who))
        self.stopped = ""
        try:
            self._log = _opened_log(folder)
            await self._start()
        except BaseException:
            lock, self._lock = self._lock, None
            await self.let_go()
            lock.undo()
            raise
        self._tick()
        return self._lock.history

    async def let_go(self) -> None:
        """Give the arm back; may be called any number of times. What the driver has open stays known."""
        if self._beat is not None:
            self._beat.cancel()
            self._beat = None
        process, self._process = self._process, None
        lock, self._lock = self._lock, None
        log, self._log = self._log, None
        if process is not None:
            await process.end()
        if lock is not None:
            lock.release(keep=bool(self.stopped))
        if log is not None:
            os.close(log)

    def acknowledge(self) -> None:
        """Permit motion again: an operator knows that the guard has stopped the arm."""
        self.stopped = ""

    def protect(self, name: str, descriptor: int, stop: bytes) -> None:
        """Take a duplicate of an open connection; see LinkGuard."""
        word = _word(name)
        self._forget(word)
        self._links[word] = (os.dup(descriptor), stop)
        self._hand_over(word)

    async def release(self, name: str) -> None:
        """Let a connection go that is closed; see LinkGuard."""
        word = _word(name)
        if word not in self._links:
            return
        self._forget(word)
        process = self._process
        self._released.discard(word)
        if process is None:
            return
        self._send(process, f"release {word}")
        deadline_s = time.monotonic() + _ANSWER_S
        while word not in self._released and not process.gone:
            # Whoever holds the duplicate of a serial line keeps it busy.
            if not await process.heard(deadline_s - time.monotonic()):
                self._give_up(process)
        if process.gone:
            await process.reaped()

    def permit(self) -> None:
        """Check, without waiting, that a motion may be written now; see LinkGuard."""
        if self._process is not None:
            # An engine that has slept finds here what the guard has done meanwhile, unless that sleeps yet.
            self._process.read()
            if self._motions and not self._process.gone and self._process.age_s > FROZEN_S:
                # Another one is started for the next motion; this one would say the same once more when it thaws.
                self._process.kill()
                self._stop_and_note(FROZEN)
        self._require_permitted()

    def _require_permitted(self) -> None:
        if self.stopped:
            raise GuardError(f"{self.stopped}: nothing moves before an operator has acknowledged that")
        if self._lock is None:
            raise GuardError(f"the arm at {self._endpoint} has no owner here: take it before it is moved")
        if self._process is None or self._process.gone:
            raise GuardError("the guard process has ended: nothing moves without it; start the run again")

    @asynccontextmanager
    async def motion(self) -> AsyncIterator[None]:
        """Have a motion guarded; see LinkGuard."""
        await self._require_guard()
        self._motions += 1
        if not self._said_moving:
            self._send_beat()
        try:
            yield
        finally:
            # The next tick says that it is over: most often another motion has begun by then.
            self._motions -= 1

    async def _require_guard(self) -> None:
        """See a guard that answers; one that has died or hangs while nothing moves is replaced."""
        if self._lock is not None and not self.stopped and not self._was_just_heard():
            # Two motions at a time would each start one.
            async with self._starting:
                answers = self._process is not None and await self._answers(self._process)
                if not answers and not self._motions:
                    await self._start()
        self._require_permitted()

    def _was_just_heard(self) -> bool:
        process = self._process
        if process is None:
            return False
        process.read()
        return not process.gone and process.age_s <= _FRESH_S

    async def _answers(self, process: GuardProcess) -> bool:
        process.read()
        deadline_s = time.monotonic() + _ANSWER_S
        while not process.gone and process.age_s > _FRESH_S:
            self._send_beat()
            if not await process.heard(deadline_s - time.monotonic()):
                self._give_up(process)
        return not process.gone

    async def _start(self) -> None:
        if self._process is not None:
            self._process.kill()
            await self._process.reaped()
        lock = self._lock
        if lock is None:
            return
        try:
            process = self._process = GuardProcess(self._said, self._gone)
        except OSError as error:
            raise GuardError(
                f"the guard process does not start ({error}): nothing moves without it"
            ) from error
        self._send(process, f"own {_word(lock.arm)} {len(lock.descriptors)}", lock.descriptors)
        if self._log is not None:
            self._send(process, "log", [self._log])
        for name in self._links:
            self._hand_over(name)
        if not await self._answers(process):
            raise GuardError(
                f"the guard process does not answer within {_ANSWER_S:g} s: nothing moves without it; see what keeps "
                "this machine busy, then start again"
            )

    def _hand_over(self, name: str) -> None:
        if self._process is not None:
            descriptor, stop = self._links[name]
            self._send(self._process, f"protect {name} {stop.hex()}", [descriptor])

    def _send(self, process: GuardProcess, text: str, descriptors: Sequence[int] = ()) -> None:
        """Send what the process has to know; one that does not take it is no guard any more."""
        if not process.say(text, descriptors):
            self._give_up(process)

    def _give_up(self, process: GuardProcess) -> None:
        if not process.gone:
            process.kill()
            self._gone()

    def _forget(self, name: str) -> None:
        if name in self._links:
            os.close(self._links.pop(name)[0])

    def _send_beat(self) -> None:
        if self._process is not None:
            self._said_moving = self._motions > 0
            self._process.say(f"beat {int(self._said_moving)}")

    def _tick(self) -> None:
        """Give a sign of life, and look for the guard's."""
        loop = asyncio.get_running_loop()
        now_s = time.monotonic()
        late = self._beat is not None and now_s > self._beat_due_s + _FRESH_S
        self._send_beat()
        process = self._process
        if process is not None and self._motions:
            process.read()
            # A loop that was late itself has only just asked again.
            if not late and now_s - process.alive_s > _ANSWER_S:
                self._give_up(process)
        self._beat_due_s = now_s + BEAT_S
        self._beat = loop.call_later(BEAT_S, self._tick)

    def _said(self, words: Sequence[str]) -> None:
        match words:
            case ["released", name]:
                self._released.add(name)
            case ["stopped", utc, *why]:
                self._stop(f"the guard stopped the arm at {utc}: {' '.join(why)}")
                if self._process is not None:
                    self._send(self._process, "understood")

    def _gone(self) -> None:
        if self._motions:
            self._stop_and_note("the guard process ended while the arm moved, which was stopped")

    def _stop_and_note(self, reason: str) -> None:
        """Stop on behalf of a guard that leaves no word itself; whoever takes the arm next may be another program."""
        if self._lock is not None:
            self._lock.note(reason)
        self._stop(reason)

    def _stop(self, reason: str) -> None:
        self.stopped = self.stopped or reason
        # Not from within a driver that is about to write a motion.
        asyncio.get_running_loop().call_soon(self.on_stop, reason)


def _opened_log(folder: Path) -> int | None:
    """Open the log, if it is a plain file; a folder that cannot be written keeps nobody from being guarded."""
    with contextlib.suppress(OSError):
        folder.mkdir(parents=True, exist_ok=True)
        path = folder / LOG_NAME
        if path.exists() and path.stat().st_size > _MOST_LOG_BYTES:
            path.replace(path.with_suffix(".log.1"))
        flags = os.O_WRONLY | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW | os.O_NONBLOCK
        descriptor = os.open(path, flags, 0o644)
        if stat.S_ISREG(os.fstat(descriptor).st_mode):
            return descriptor
        os.close(descriptor)
    return None


def _word(text: str) -> str:
    """Return a name as one word of a message."""
    return _NO_WORD.sub("-", text)
