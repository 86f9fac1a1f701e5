"""A link that loses, doubles and garbles answers."""

import random
from typing import Literal, get_args

Mishap = Literal["lost", "doubled", "garbled"]

_HIGHEST_BIT = 0x80


class Lossy:
    """Spoils a share of what a device says; the rest passes unchanged.

    A garbled answer is no valid one: the highest bit of its first byte is flipped. What is another valid answer no
    link can notice.

    Args:
        share: of the answers that are spoilt, 0...1.

    Attributes:
        spoilt: how many answers were, by mishap.
    """

    def __init__(self, share: float, seed: int) -> None:
        self._share = share
        self._random = random.Random(seed)
        self.spoilt: dict[Mishap, int] = dict.fromkeys(get_args(Mishap), 0)

    def passed(self, answer: bytes) -> bytes:
        """Return what arrives of an answer."""
        if self._random.random() >= self._share:
            return answer
        mishap: Mishap = self._random.choice(get_args(Mishap))
        self.spoilt[mishap] += 1
        match mishap:
            case "lost":
                return b""
            case "doubled":
                return answer + answer
            case "garbled":
                return bytes([answer[0] ^ _HIGHEST_BIT]) + answer[1:]
