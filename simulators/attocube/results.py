"""What a method of the emulated IDS gives back."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Later:
    """A result that is due after some bench time; the client waits for it.

    Attributes:
        due: bench time to wait for, None when the result is due.
        result: makes the result.
    """

    due: Callable[[], float | None]
    result: Callable[[], list[object]]


Result = list[object] | str | Later

Method = Callable[..., Result]
