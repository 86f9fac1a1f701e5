"""What goes wrong at random with the bytes that pass a proxy: one kind of fault on one way of a link.

==============  ========================================================================================
split           the piece comes in two, a moment apart
coalesce        the piece waits for the next one and comes together with it
delay           the piece comes up to `longest_s` later, and all that follows behind it
drop            some bytes of the piece in a row are lost, or all of them
duplicate       the piece comes twice
corrupt         the highest bit of a byte is flipped
digit           the lowest bit of a digit is flipped, which makes it another digit; without a digit, of any byte
stall           from here on nothing passes this way until the link is opened again
half-close      behind the piece this way is ended; the other one stays open
==============  ========================================================================================
"""

import random
from dataclasses import dataclass
from typing import Final, Literal, get_args

Kind = Literal["split", "coalesce", "delay", "drop", "duplicate", "corrupt", "digit", "stall", "half-close"]

KINDS: Final[tuple[Kind, ...]] = get_args(Kind)

_HIGHEST_BIT: Final = 0x80
_LOWEST_BIT: Final = 0x01
_DIGITS: Final = b"0123456789"
_APART_S: Final = 0.01


@dataclass(frozen=True)
class Piece:
    """What passes, after a pause."""

    data: bytes
    pause_s: float = 0.0


class Mishaps:
    """Faults of one kind on one way of all connections of a proxy.

    Args:
        seed: of when, and of what exactly.
        first: number of the piece that the first fault strikes.
        share: of the later pieces that faults strike, 0...1.
        longest_s: delay, real s.

    Attributes:
        kind: what goes wrong.
        struck: how often something did.
    """

    def __init__(self, kind: Kind, seed: str, *, first: int, share: float, longest_s: float = 1.0) -> None:
        self.kind = kind
        self.struck = 0
        self._random = random.Random(seed)
        self._next = first
        self._share = share
        self._longest_s = longest_s

    def way(self) -> "Way":
        """Return the way of a new connection."""
        return Way(self)

    def strike(self) -> bool:
        """Return whether a fault strikes the piece that passes now."""
        self._next -= 1
        if self._next >= 0 or (self.struck and self._random.random() >= self._share):
            return False
        self.struck += 1
        return True

    def pieces(self, data: bytes) -> list[Piece]:
        """Return what a piece becomes by a fault that needs no memory."""
        match self.kind:
            case "split" if len(data) > 1:
                at = self._random.randrange(1, len(data))
                return [Piece(data[:at]), Piece(data[at:], _APART_S)]
            case "delay":
                return [Piece(data, self._random.uniform(0.0, self._longest_s))]
            case "drop":
                begin = self._random.randrange(len(data))
                return [Piece(data[:begin] + data[self._random.randint(begin + 1, len(data)) :])]
            case "duplicate":
                return [Piece(data + data)]
            case "corrupt":
                return [Piece(_flipped(data, self._random.randrange(len(data)), _HIGHEST_BIT))]
            case "digit":
                digits = [at for at, byte in enumerate(data) if byte in _DIGITS] or range(len(data))
                return [Piece(_flipped(data, self._random.choice(digits), _LOWEST_BIT))]
        return [Piece(data)]


class Way:
    """One direction of one connection.

    Attributes:
        ended: the other side is to be told that nothing more comes.
    """

    def __init__(self, mishaps: Mishaps) -> None:
        self._mishaps = mishaps
        self._held = b""
        self._silent = False
        self.ended = False

    def passed(self, data: bytes) -> list[Piece]:
        """Return what arrives of a piece, and when."""
        if self._silent or self.ended:
            return []
        data, held = self._held + data, bool(self._held)
        self._held = b""
        if held or not self._mishaps.strike():
            return [Piece(data)]
        match self._mishaps.kind:
            case "coalesce":
                self._held = data
                return []
            case "stall":
                self._silent = True
                return []
            case "half-close":
                self.ended = True
        return self._mishaps.pieces(data)


def _flipped(data: bytes, at: int, mask: int) -> bytes:
    return data[:at] + bytes([data[at] ^ mask]) + data[at + 1 :]
