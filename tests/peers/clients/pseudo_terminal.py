"""Open pseudo-terminals as serial lines: they have neither parity nor 7 bits, and the C library refuses to set them.

glibc reads the settings back and reports EINVAL. A real port takes them, and clients with fixed settings know of no
other line; so what a pseudo-terminal cannot hold is left out.
"""

import termios
from typing import Any

_set = termios.tcsetattr


def take_parity() -> None:
    """Let clients of this process set parity and bits on a pseudo-terminal."""
    vars(termios)["tcsetattr"] = _without_parity


def _without_parity(port: int, when: int, attributes: list[Any]) -> None:
    cflag = attributes[2] & ~(termios.PARENB | termios.CSIZE) | termios.CS8
    _set(port, when, [*attributes[:2], cflag, *attributes[3:]])
