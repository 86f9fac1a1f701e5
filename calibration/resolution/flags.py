"""What was noticed about a recording and its steps: shown beside the result, never silently mended."""

from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from typing import Final, Literal

from catseye.calibration.core.types import Bools

FlagKind = Literal[
    "irregular-sampling",
    "gap",
    "outlier",
    "missed",
    "frozen-signal",
    "drift",
    "changing-drift",
    "no-standstill",
    "quantised",
    "below-instrument",
    "no-motion",
    "merged",
    "disturbed",
    "reversed",
    "unsettled",
    "late",
    "unexpected-motion",
    "partial-mean",
    "least-step-open",
    "masked-by-reversal",
    "torque",
    "torque-clock",
    "clocks",
    "scale",
    "ratio",
]

_OF_DATA: Final[frozenset[FlagKind]] = frozenset(
    {
        "outlier",
        "missed",
        "frozen-signal",
        "no-standstill",
        "changing-drift",
        "scale",
        "torque-clock",
    }
)
"""What speaks against a recording or its moves, whatever the joint does."""

_OF_STEPS: Final[frozenset[FlagKind]] = frozenset(
    {"no-motion", "merged", "disturbed", "reversed", "late", "unexpected-motion"}
)
"""What steps do that are too small for the joint, and larger ones do not."""

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


def doubts(flags: Iterable[Flag], followed: Collection[int]) -> list[Flag]:
    """Return the flags that speak against a result, not those that belong to every good test.

    What steps do that are smaller than the joint follows says nothing.

    Args:
        flags: of the test.
        followed: numbers of the moves that the joint should follow, by the result.
    """
    return [
        flag
        for flag in flags
        if flag.kind in _OF_DATA
        or (flag.kind in _OF_STEPS and not (flag.moves and set(followed).isdisjoint(flag.moves)))
    ]


def listed(numbers: Sequence[int]) -> str:
    """Return the numbers of moves as a text names them."""
    if len(numbers) == 1:
        return f"move {numbers[0]}"
    shown = ", ".join(str(number) for number in numbers[:_LISTED])
    more = f" and {len(numbers) - _LISTED} more" if len(numbers) > _LISTED else ""
    return f"moves {shown}{more}"
