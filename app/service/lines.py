"""Lines that are typed at this process, read without blocking the event loop."""

import asyncio
import os
import signal
from collections.abc import Callable, Iterator
from contextlib import contextmanager

_CHUNK_BYTES = 65_536

_LONGEST_LINE_BYTES = 65_536
"""A device such as /dev/zero never ends a line, and would take all memory."""

_MOST_CHUNKS = 64
"""Of what never keeps anybody waiting: it is read at once, and a device without end would be read for ever."""

_FOREGROUND_POLL_S = 0.5


class Lines:
    """Reads a descriptor line by line.

    A process in the background leaves its terminal alone: reading there would stop the process, with the arm moving.

    Args:
        on_line: takes each line, without its end.
        on_end: called when no line follows, or none that anybody types.
        keys: takes single keys from what was read and returns what belongs to lines.
    """

    def __init__(
        self,
        descriptor: int,
        on_line: Callable[[str], None],
        on_end: Callable[[], None] = lambda: None,
        keys: Callable[[bytes], bytes] = lambda chunk: chunk,
    ) -> None:
        self._descriptor = descriptor
        self._on_line = on_line
        self._on_end = on_end
        self._keys = keys
        self._rest = b""
        self._timer: asyncio.TimerHandle | None = None
        self._open = False

    @contextmanager
    def read(self) -> Iterator[None]:
        """Read while the context is entered."""
        before = signal.signal(signal.SIGTTIN, signal.SIG_IGN)
        self._open = True
        self._begin()
        try:
            yield
        finally:
            self._pause()
            self._open = False
            signal.signal(signal.SIGTTIN, before)

    def _begin(self) -> None:
        try:
            asyncio.get_running_loop().add_reader(self._descriptor, self._readable)
        except PermissionError:
            # A plain file, or the null device: it never keeps anybody waiting.
            for _ in range(_MOST_CHUNKS):
                if not self._open:
                    return
                self._readable()
            if self._open:
                self._end()

    def _pause(self) -> None:
        asyncio.get_running_loop().remove_reader(self._descriptor)
        if self._timer is not None:
            self._timer.cancel()

    def _readable(self) -> None:
        if not in_foreground(self._descriptor):
            self._pause()
            self._timer = asyncio.get_running_loop().call_later(_FOREGROUND_POLL_S, self._begin)
            return
        try:
            chunk = os.read(self._descriptor, _CHUNK_BYTES)
        except OSError:
            chunk = b""
        if not chunk:
            self._end()
            return
        *lines, self._rest = (self._rest + self._keys(chunk)).split(b"\n")
        for line in lines:
            self._on_line(line.decode(errors="replace").rstrip("\r"))
        if len(self._rest) > _LONGEST_LINE_BYTES:
            self._end()

    def _end(self) -> None:
        self._pause()
        self._open = False
        self._on_end()


def in_foreground(descriptor: int) -> bool:
    """Return whether this process may read a terminal; whatever else a descriptor is, it may."""
    if not os.isatty(descriptor):
        return True
    try:
        return os.tcgetpgrp(descriptor) == os.getpgrp()
    except OSError:
        # It is not this process's terminal: nothing forbids reading.
        return True
