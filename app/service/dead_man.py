"""A dead-man switch made of key presses alone: terminals do not report when a key is released."""

from dataclasses import dataclass
from typing import Final, Generic, TypeVar

T = TypeVar("T")

FIRST_REPEAT_S: Final = 1.0
"""A key that is held begins to repeat within so long: keyboards wait 0.25 s to 1 s, 0.5 s or 0.66 s as a rule."""

REPEAT_S: Final = 0.3
"""A held key repeats more often than this: keyboards do so every 0.03 s to 0.1 s; the rest is for a slow line."""


@dataclass
class DeadMan(Generic[T]):
    """Says what a held key asks for.

    Nothing is asked for before the key has repeated once: during the keyboard's delay nobody can tell a key that is
    held from one that was let go, so nothing moves in it, and a tap moves nothing at all. From the last repeat on the
    key counts as held for 0.3 s, never for the length of that delay.
    """

    _asked: T | None = None
    _last_s: float = 0.0
    _repeats: bool = False

    def press(self, asked: T, now_s: float) -> None:
        """Take a press or a repeat of a key.

        Args:
            now_s: monotonic time, s.
        """
        patience_s = REPEAT_S if self._repeats else FIRST_REPEAT_S
        self._repeats = asked == self._asked and now_s - self._last_s <= patience_s
        self._asked, self._last_s = asked, now_s

    def let_go(self) -> None:
        """Forget the key; it has to be pressed and to repeat anew."""
        self._asked, self._repeats = None, False

    def held(self, now_s: float) -> T | None:
        """Return what the key that is held asks for; None when none is."""
        if self._repeats and now_s - self._last_s > REPEAT_S:
            self.let_go()
        return self._asked if self._repeats else None
