"""Independent items of work, shared over processes or machines, with the same results however many there are."""

import os
import reprlib
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol, TypeVar

from catseye.app.cluster.trust import require_trusted

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
            done: is told how many items are finished, each time one is.

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


@contextmanager
def sharing(workers: int, dask: str | None, *, insecure: bool = False) -> Iterator[Share]:
    """Provide who carries out work; at the end, also after Ctrl-C, no process is left behind.

    Args:
        workers: 1 for this process alone, 0 for one process a core, otherwise so many processes.
        dask: address of a dask.distributed scheduler whose workers do it instead; None for this machine.
        insecure: the scheduler may be outside of this machine, and the connection without TLS.

    Raises:
        ConfigError: the scheduler cannot be used: it is not to be trusted, the package is missing, nobody answers,
            there are no workers, or they have other versions.
    """
    if workers < 0:
        raise ValueError(f"{workers} workers; 0 takes one a core")
    # Both are imported only when they are asked for: most commands share nothing.
    if dask is not None:
        require_trusted(dask, insecure=insecure)
        from catseye.app.cluster.machines import machines

        with machines(dask) as share:
            yield share
    elif workers == 1:
        yield InThisProcess()
    else:
        from catseye.app.cluster.processes import processes

        with processes(workers or cores()) as share:
            yield share


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def name_item(error: BaseException, number: int, items: Sequence[object]) -> None:
    """Add to an error which item it comes from."""
    error.add_note(f"in item {number} of {len(items)}: {reprlib.repr(items[number - 1])}")
