"""What independent items of work are shared with, with the same results whoever carries them out."""

import math
import reprlib
import time
from collections.abc import Callable, Sequence
from typing import Protocol, TypeVar

A = TypeVar("A")
B = TypeVar("B")


_WORTH_WAITING = 10.0
"""Work is handed over when it would take so many times as long here as others take to begin."""


class Share(Protocol):
    """Whoever carries out items of work."""

    @property
    def begins_after_s(self) -> float:
        """What it takes until the first item is begun, s; infinite for this process, which gains nothing by it."""
        ...

    def map(
        self, function: Callable[[A], B], items: Sequence[A], done: Callable[[int], None] | None = None
    ) -> list[B]:
        """Carry out a function on each item.

        Args:
            function: of a module, not of another function: other processes look it up by its name. It has to depend
                on its item alone; whatever is random in it comes from a seed in the item.
            items: what it is called with; they and the results travel as pickles.
            done: is called with the number of finished items, each time it grows.

        Returns:
            Results in the order of the items.

        Raises:
            WorkerLostError: a worker ended before its item was finished.
            Exception: what the function raised, with a note that names the item; the other items are given up.
        """
        ...


class InThisProcess:
    """Carries out item after item here."""

    begins_after_s = math.inf

    def map(
        self, function: Callable[[A], B], items: Sequence[A], done: Callable[[int], None] | None = None
    ) -> list[B]:
        """Carry out a function on each item; see Share."""
        results = []
        for number in range(1, len(items) + 1):
            results.append(_carried_out(function, items, number))
            if done is not None:
                done(number)
        return results


def map_quick(
    share: Share,
    function: Callable[[A], B],
    items: Sequence[A],
    done: Callable[[int], None] | None = None,
    clock: Callable[[], float] = time.perf_counter,
) -> list[B]:
    """Carry out items that may all be done here before others have begun; arguments and results as of Share.map.

    Items are carried out here until the time that they take shows that the rest is worth handing over.
    """
    results: list[B] = []
    start_s = clock()
    while len(results) < len(items):
        left = len(items) - len(results)
        spent_s = clock() - start_s
        if results and spent_s / len(results) * left > _WORTH_WAITING * share.begins_after_s:
            break
        results.append(_carried_out(function, items, len(results) + 1))
        if done is not None:
            done(len(results))
    first = len(results)
    advanced = None if done is None else (lambda number: done(first + number))
    return results + share.map(function, items[first:], advanced)


def _carried_out(function: Callable[[A], B], items: Sequence[A], number: int) -> B:
    try:
        return function(items[number - 1])
    except Exception as error:
        name_item(error, number, items)
        raise


def name_item(error: BaseException, number: int, items: Sequence[object]) -> None:
    """Add to an error which item it comes from."""
    error.add_note(f"in item {number} of {len(items)}: {reprlib.repr(items[number - 1])}")
