"""stdout and stderr of a process that may not wait for whoever reads them: an arm may be moving."""

import asyncio
import io
import os
import select
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Final, TextIO, cast

from catseye.app.errors import ReaderStuckError

CAPACITY_BYTES: Final = 1 << 20
"""Of text that waits for a reader: about 5000 events."""

_TERMINAL_BYTES: Final = 256
"""What a terminal takes without waiting when it is said to be writable; a pipe takes `PIPE_BUF`."""

_LAST_S: Final = 2.0
"""Real s for what waits at the end of the process."""


class Outlet(io.TextIOBase):
    """Writes to a descriptor; what its reader does not take at once waits here, as far as there is room.

    Args:
        descriptor: stays open.
        capacity_bytes: how much waits at most.
    """

    def __init__(self, descriptor: int, capacity_bytes: int = CAPACITY_BYTES) -> None:
        self._descriptor = descriptor
        self._capacity_bytes = capacity_bytes
        self._chunk_bytes = _TERMINAL_BYTES if self.isatty() else select.PIPE_BUF
        self._waiting = bytearray()
        self._failure: OSError | None = None
        self._poll = select.poll()
        self._poll.register(descriptor, select.POLLOUT)

    def fileno(self) -> int:
        """Return the descriptor."""
        return self._descriptor

    def isatty(self) -> bool:
        """Return whether it is a terminal."""
        return os.isatty(self._descriptor)

    def writable(self) -> bool:
        """Return that it can be written."""
        return True

    def write(self, text: str) -> int:
        """Write a text, or keep it until its reader takes it.

        Raises:
            ReaderStuckError: too much waits already; nothing of the text is written.
            OSError: nobody reads any more, or the disk is full; what waited is lost.
        """
        if (failure := self._failure) is not None:
            self._failure = None
            raise failure
        data = text.encode(errors="backslashreplace")
        self._send()
        if len(self._waiting) + len(data) > self._capacity_bytes:
            raise ReaderStuckError(f"its reader has left {len(self._waiting)} bytes unread")
        self._waiting += data
        self._send()
        return len(text)

    def drain(self, limit_s: float) -> bool:
        """Wait until what waits is taken, for a bounded time; return whether it is.

        Raises:
            OSError: nobody reads any more, or the disk is full.
        """
        while self._waiting and self._poll.poll(limit_s * 1000.0):
            self._send()
        return not self._waiting

    def _send(self) -> None:
        """Write as much as is taken without waiting; the rest follows when the reader goes on."""
        try:
            while self._waiting and self._poll.poll(0):
                del self._waiting[: os.write(self._descriptor, self._waiting[: self._chunk_bytes])]
        except OSError:
            self._waiting.clear()
            raise
        finally:
            self._watch()

    def _watch(self) -> None:
        # Without a loop nothing goes on by itself; nothing has to, there.
        with suppress(RuntimeError):
            loop = asyncio.get_running_loop()
            if self._waiting:
                loop.add_writer(self._descriptor, self._resume)
            else:
                loop.remove_writer(self._descriptor)

    def _resume(self) -> None:
        try:
            self._send()
        except OSError as error:
            # Whoever writes next hears of it.
            self._failure = error


@contextmanager
def patient_output(last_s: float = _LAST_S) -> Iterator[None]:
    """Let nothing that this process says wait for its reader meanwhile.

    Args:
        last_s: real s for what waits at the end; what is not taken by then goes nowhere.
    """
    kept = sys.stdout, sys.stderr
    sys.stdout, sys.stderr = (_outlet(stream) for stream in kept)
    try:
        yield
    finally:
        for stream in (sys.stdout, sys.stderr):
            if isinstance(stream, Outlet):
                _leave(stream, last_s)
        sys.stdout, sys.stderr = kept


def _outlet(stream: TextIO) -> TextIO:
    try:
        descriptor = stream.fileno()
    except OSError:
        # It is kept in memory, which makes nobody wait.
        return stream
    with suppress(OSError):
        stream.flush()
    return cast(TextIO, Outlet(descriptor))


def _leave(outlet: Outlet, last_s: float) -> None:
    taken = False
    with suppress(OSError):
        taken = outlet.drain(last_s)
    if not taken:
        # What is said from here on would wait for the same reader.
        with open(os.devnull, "wb") as nowhere:
            os.dup2(nowhere.fileno(), outlet.fileno())
