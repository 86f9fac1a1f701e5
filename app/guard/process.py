"""The guard process as its engine sees it: started, spoken to, heard, and reaped."""

import asyncio
import contextlib
import os
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Sequence
from pathlib import Path

from catseye.app.guard.guard import boot_s

_PROGRAM = Path(__file__).with_name("guard.py")
_MESSAGE_BYTES = 65_536
_END_S = 2.0
_REAP_POLL_S = 0.005


class GuardProcess:
    """One guard process.

    Args:
        on_said: is called with the words of each message.
        on_gone: is called once when the process is gone without having been asked to end.

    Attributes:
        alive_s: monotonic time of the process's latest sign of life, by its own account.
    """

    def __init__(self, on_said: Callable[[Sequence[str]], None], on_gone: Callable[[], None]) -> None:
        self.alive_s = self._alive_boot_s = -1e9
        self._on_said = on_said
        self._on_gone = on_gone
        self._loop = asyncio.get_running_loop()
        self._heard = asyncio.Event()
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs:
            try:
                self._process = _started(theirs)
            except BaseException:
                ours.close()
                raise
        self._link: socket.socket | None = ours
        ours.setblocking(False)
        self._loop.add_reader(ours, self.read)

    @property
    def pid(self) -> int:
        """Number of the process."""
        return self._process.pid

    @property
    def age_s(self) -> float:
        """Time since its latest sign of life; also what the machine was suspended for."""
        return boot_s() - self._alive_boot_s

    @property
    def gone(self) -> bool:
        """The process takes no message any more."""
        return self._link is None

    def say(self, text: str, descriptors: Sequence[int] = ()) -> bool:
        """Send a message, without waiting; return whether it was taken."""
        if self._link is None:
            return False
        try:
            if descriptors:
                socket.send_fds(self._link, [text.encode()], list(descriptors))
            else:
                self._link.send(text.encode())
        except OSError:
            # A process that takes nothing, or has gone, shows by what it says no more.
            return False
        return True

    def read(self) -> None:
        """Take every message that has come, without waiting."""
        while self._link is not None:
            try:
                data = self._link.recv(_MESSAGE_BYTES)
            except (BlockingIOError, InterruptedError):
                return
            except OSError:
                data = b""
            if not data:
                self._let_go()
                self._on_gone()
                return
            self._take(data.decode().split(" "))

    async def heard(self, limit_s: float) -> bool:
        """Wait for the next message or the end of the process; return whether it came in time."""
        self._heard.clear()
        with contextlib.suppress(TimeoutError):
            async with asyncio.timeout(limit_s):
                await self._heard.wait()
                return True
        return False

    def kill(self) -> None:
        """End the process, without waiting; what it holds is free when it is reaped."""
        self._let_go()

    async def reaped(self) -> bool:
        """See a process end that was killed, or is about to end; return whether it has within a bounded time.

        One that hangs in a driver of the operating system outlives even SIGKILL for a time.
        """
        deadline_s = time.monotonic() + _END_S
        # Nothing that the loop could wait for shows it on every system.
        while self._process.poll() is None and time.monotonic() < deadline_s:  # noqa: ASYNC110  # see above
            await asyncio.sleep(_REAP_POLL_S)
        return self._process.poll() is not None

    async def end(self) -> None:
        """Have the process let everything go, and see it end."""
        self._on_gone = _nothing
        self.say("end")
        deadline_s = time.monotonic() + _END_S
        while self._link is not None and time.monotonic() < deadline_s:
            await self.heard(deadline_s - time.monotonic())
        self._let_go()
        await self.reaped()

    def _take(self, words: list[str]) -> None:
        if words[0] == "alive":
            self.alive_s, self._alive_boot_s = map(float, words[1:])
        self._on_said(words)
        self._heard.set()

    def _let_go(self) -> None:
        if self._link is not None:
            # It has closed its end, or is given up: either way the end is near. Killed before the pair is closed, it
            # does not take this program for dead.
            self._process.kill()
            self._loop.remove_reader(self._link)
            self._link.close()
            self._link = None
        self._heard.set()


def _started(theirs: socket.socket) -> "subprocess.Popen[bytes]":
    descriptor = theirs.fileno()
    return subprocess.Popen(
        [sys.executable, "-I", "-S", str(_PROGRAM), str(descriptor), str(os.getpid())],
        pass_fds=(descriptor,),
        # Neither a signal to the group, nor Ctrl-C or Ctrl-Z at the terminal reaches it.
        start_new_session=True,
        cwd="/",
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


def _nothing() -> None:
    """Do nothing: the end was asked for."""
