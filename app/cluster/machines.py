"""Work shared over the machines of a dask.distributed scheduler."""

import platform
import queue
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from importlib import metadata
from typing import TypeVar

from app.cluster.errors import WorkerLostError
from app.cluster.sharing import name_item
from app.errors import ConfigError

try:
    from distributed import Client, Future, KilledWorker
except ImportError as missing:
    raise ConfigError(
        "--dask needs the package distributed, which is not installed: pip install 'catseye[cluster]'"
    ) from missing

A = TypeVar("A")
B = TypeVar("B")

_CONNECT_S = 10.0
"""A scheduler that does not answer within this time is taken as absent."""

_LOOK_S = 2.0
"""How often it is looked whether there still are workers while nothing arrives."""

_PATIENCE = 5
"""After so many looks without any worker the work is given up."""

_PACKAGES = ("catseye", "numpy", "scipy", "distributed")


class Machines:
    """Carries out items on the workers of a scheduler.

    Args:
        client: connection to the scheduler.
    """

    def __init__(self, client: Client) -> None:
        self._client = client

    def map(
        self, function: Callable[[A], B], items: Sequence[A], done: Callable[[int], None] | None = None
    ) -> list[B]:
        """Carry out a function on each item; see Share."""
        # Not "pure": the scheduler would answer a repeated item from its memory.
        futures: list[Future[B]] = self._client.map(function, list(items), pure=False)
        finished: queue.Queue[int] = queue.Queue()
        try:
            for i, future in enumerate(futures):
                future.add_done_callback(lambda _, i=i: finished.put(i))
            for count in range(1, len(items) + 1):
                i = self._next(finished)
                _raise_with_item(futures[i], i + 1, items)
                if done is not None:
                    done(count)
            results: list[B] = self._client.gather(futures)
            return results
        finally:
            self._client.cancel(futures)

    def _next(self, finished: queue.Queue[int]) -> int:
        """Wait for an item, as long as there are workers.

        Raises:
            WorkerLostError: no worker is left, or the scheduler is gone.
        """
        looks_without = 0
        while looks_without < _PATIENCE:
            try:
                return finished.get(timeout=_LOOK_S)
            except queue.Empty:
                alive = self._client.status == "running" and self._client.nthreads()
                looks_without = 0 if alive else looks_without + 1
        raise WorkerLostError(
            "no worker of the dask scheduler is left, or the scheduler itself is gone: start them and repeat"
        )


def _raise_with_item(future: Future[B], number: int, items: Sequence[object]) -> None:
    if future.status == "finished":
        return
    error = future.exception()
    if future.status == "cancelled" or isinstance(error, KilledWorker):
        raise WorkerLostError(
            f"the dask workers lost item {number} of {len(items)} ({error}): look into their logs whether the "
            "memory did not suffice, and repeat"
        ) from error
    name_item(error, number, items)
    raise error


@contextmanager
def machines(address: str) -> Iterator[Machines]:
    """Connect to a scheduler.

    Raises:
        ConfigError: nobody answers, there are no workers, or they have other versions.
    """
    try:
        client = Client(address, timeout=_CONNECT_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise ConfigError(
            f"no dask scheduler answers at {address} within {_CONNECT_S:g} s ({error}): start one with "
            "`dask scheduler` and give the address that it prints, as tcp://HOST:8786"
        ) from error
    with client:
        _require_like_here(client, address)
        yield Machines(client)


def versions() -> dict[str, str]:
    """Return the versions that results and messages between machines depend on, of the process asked."""
    return {
        "python": ".".join(platform.python_version_tuple()[:2]),
        **{name: metadata.version(name) for name in _PACKAGES},
    }


def _require_like_here(client: Client, address: str) -> None:
    try:
        there: dict[str, dict[str, str]] = client.run(versions)
    except ModuleNotFoundError as error:
        raise ConfigError(
            f"a dask worker of {address} cannot import {error.name}: install the same catseye[cluster] "
            "on each machine"
        ) from error
    if not there:
        raise ConfigError(
            f"the dask scheduler at {address} has no workers: start some with `dask worker {address}`"
        )
    here = versions()
    faults = [
        f"worker {worker} has {name} {theirs[name]}, here is {here[name]}"
        for worker, theirs in sorted(there.items())
        for name in here
        if theirs[name] != here[name]
    ]
    if faults:
        raise ConfigError(
            f"{'; '.join(faults)}: install the same versions, only then the numbers are the same"
        )
