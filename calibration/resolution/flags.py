"""What was noticed about a recording and its steps: shown beside the result, never silently mended."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from catseye.calibration.core.types import Bools

FlagKind = Literal[
    "irregular-sampling",
    "gap",
    "missed",
    "frozen-signal",
    "drift",
    "no-standstill",
    "quantised",
    "below-instrument",
    "no-motion",
    "merged",
    "reversed",
    "unsettled",
    "late",
    "unexpected-motion",
    "partial-mean",
    "least-step-open",
    "masked-by-reversal",
    "torque",
    "clocks",
]

_LISTED = 8
"""Moves that a text names; of more it says how many."""


@dataclass(frozen=True)
class Flag:
    """Something that a reader of the result has to know.

    Attributes:
        kind: what it is, for programs.
        text: what was found, where, and what it means.
        moves: numbers of the moves concerned, counting from 1; empty where it concerns all of them.
    """

    kind: FlagKind
    text: str
    moves: tuple[int, ...] = ()


def flag_moves(kind: FlagKind, concerned: Bools, what: str, first: int = 1) -> list[Flag]:
    """Return a flag for the moves concerned, none where there are none.

    Args:
        concerned: for each move, shape (n,).
        what: what the text says after the moves' numbers.
        first: number of the first move.
    """
    numbers = tuple(int(number) + first for number in concerned.nonzero()[0])
    return [Flag(kind, f"{listed(numbers)}: {what}", numbers)] if numbers else []


def listed(numbers: Sequence[int]) -> str:
    """Return the numbers of moves as a text names them."""
    if len(numbers) == 1:
        return f"move {numbers[0]}"
    shown = ", ".join(str(number) for number in numbers[:_LISTED])
    more = f" and {len(numbers) - _LISTED} more" if len(numbers) > _LISTED else ""
    return f"moves {shown}{more}"
