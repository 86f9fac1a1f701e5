"""A terminal with the user interface in it: keys go in, the screen can be read as a person reads it."""

import fcntl
import os
import pty
import select
import struct
import subprocess
import sys
import termios
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pyte

from tests.patience import HANG_S
from tests.system.command import environment

KEYS = {
    "f1": "\x1bOP",
    "f2": "\x1bOQ",
    "f3": "\x1bOR",
    "f4": "\x1bOS",
    "f5": "\x1b[15~",
    "f6": "\x1b[17~",
    "f7": "\x1b[18~",
    "f8": "\x1b[19~",
    "f9": "\x1b[20~",
    "f10": "\x1b[21~",
    "f12": "\x1b[24~",
    "up": "\x1b[A",
    "down": "\x1b[B",
    "right": "\x1b[C",
    "left": "\x1b[D",
    "home": "\x1b[H",
    "enter": "\r",
    "tab": "\t",
    "escape": "\x1b",
    "ctrl+c": "\x03",
    "ctrl+p": "\x10",
    "ctrl+q": "\x11",
    "ctrl+s": "\x13",
    "focus lost": "\x1b[O",
}


CATSEYE = ("-m", "catseye")

READ_S = 1.5
"""A key that lets the arm move counts only a moment after the dialog came."""

_TAKEN_S = 1.0
"""For the words of a program that never stops writing."""

_NEXT_S = 0.002
"""Within it the rest of one repaint follows: a pseudo-terminal holds 4 kB, a large screen takes more."""


class Screen:
    """A command in a pseudo-terminal; closing it is what a closed window does.

    Args:
        arguments: of the program.
        cwd: where it runs.
        size: columns and lines.
        program: arguments of Python that start it.

    Attributes:
        received: all bytes that the program wrote to its terminal so far.
        read_at_s: when the last of them came, on the monotonic clock.
    """

    def __init__(
        self,
        *arguments: str | Path,
        cwd: Path,
        size: tuple[int, int] = (80, 24),
        program: tuple[str, ...] = CATSEYE,
    ) -> None:
        self.descriptor, slave = pty.openpty()
        columns, lines = size
        fcntl.ioctl(slave, termios.TIOCSWINSZ, struct.pack("HHHH", lines, columns, 0, 0))
        self._screen = pyte.Screen(columns, lines)
        self._stream = pyte.ByteStream(self._screen)
        self._open = True
        self.received = b""
        self.read_at_s = time.monotonic()
        self.process = subprocess.Popen(
            [sys.executable, *program, *map(str, arguments)],
            cwd=cwd,
            env={**environment(), "TERM": "xterm-256color"},
            stdin=slave,
            stdout=slave,
            stderr=slave,
            preexec_fn=_own_terminal,
        )
        os.close(slave)

    @property
    def text(self) -> str:
        """What stands on the screen now."""
        self._take_in(0.0)
        return "\n".join(line.rstrip() for line in self._screen.display)

    def press(self, *keys: str) -> None:
        """Press keys by their names, or characters."""
        for key in keys:
            assert key in KEYS or len(key) == 1, key
            os.write(self.descriptor, KEYS.get(key, key).encode())

    def shows(self, *texts: str, limit_s: float = HANG_S) -> str:
        """Wait until all texts stand on the screen; return it."""
        end_s = time.monotonic() + limit_s
        while not all(text in self.text for text in texts):
            assert time.monotonic() < end_s, f"{texts} not on the screen:\n{self.text}"
            assert self._take_in(0.2), f"the program ended without {texts}:\n{self.text}"
        return self.text

    def let_go_on(self) -> None:
        """Continue a held run, by the dialog that shows what will move."""
        self.press("f8")
        self.shows("goes on where it was held")
        time.sleep(READ_S)
        self.press("f8")
        self.shows("EXECUTE")

    def ended(self, limit_s: float = HANG_S) -> int:
        """Wait for the end of the program, its output taken in; return its exit code."""
        end_s = time.monotonic() + limit_s
        while self.process.poll() is None:
            assert time.monotonic() < end_s, self.text
            self._take_in(0.1)
        return self.process.returncode

    def close(self) -> None:
        """Close the terminal."""
        if self._open:
            self._open = False
            os.close(self.descriptor)

    def _take_in(self, wait_s: float) -> bool:
        """Take in what the program wrote; return whether it may write more.

        On a busy computer it may write faster than it is read: whoever waited for its last word waited for ever.
        """
        if not self._open:
            return False
        end_s = time.monotonic() + wait_s + _TAKEN_S
        taken = []
        while time.monotonic() < end_s and select.select([self.descriptor], [], [], wait_s)[0]:
            try:
                taken.append(os.read(self.descriptor, 65536))
            except OSError:
                self._feed(taken)
                return False
            self.read_at_s = time.monotonic()
            wait_s = _NEXT_S
        self._feed(taken)
        return self.process.poll() is None

    def _feed(self, taken: list[bytes]) -> None:
        """Draw what was taken in; the program waited for none of it, as it waits for no real terminal."""
        data = b"".join(taken)
        self.received += data
        self._stream.feed(data)


@contextmanager
def on_screen(
    *arguments: str | Path, cwd: Path, size: tuple[int, int] = (80, 24), program: tuple[str, ...] = CATSEYE
) -> Iterator[Screen]:
    """Run a command in a terminal and end it at last."""
    screen = Screen(*arguments, cwd=cwd, size=size, program=program)
    try:
        yield screen
    finally:
        screen.close()
        screen.process.kill()
        screen.process.wait(HANG_S)


def _own_terminal() -> None:
    os.setsid()
    fcntl.ioctl(0, termios.TIOCSCTTY, 0)
