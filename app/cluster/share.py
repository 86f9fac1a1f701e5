"""What independent items of work are shared with, with the same results whoever carries them out."""

import reprlib
from collections.abc import Callable, Sequence
from typing import Protocol, TypeVar

A = TypeVar("A")
B = TypeVar("B")


class Share(Protocol):
    """Whoever carries out items of work."""

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

    def map(
        self, function: Callable[[A], B], items: Sequence[A], done: Callable[[int], None] | None = None
    ) -> list[B]:
        """Carry out a function on each item; see Share."""
        results = []
        for number, item in enumerate(items, 1):
            try:
                results.append(function(item))
            except Exception as error:
                name_item(error, number, items)
                raise
            if done is not None:
                done(number)
        return results


def name_item(error: BaseException, number: int, items: Sequence[object]) -> None:
    """Add to an error which item it comes from."""
    error.add_note(f"in item {number} of {len(items)}: {reprlib.repr(items[number - 1])}")
