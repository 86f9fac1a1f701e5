"""Work shared over the machines of a dask.distributed scheduler."""

import platform
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import contextmanager
from importlib import metadata
from typing import TypeVar

from catseye.app.cluster.errors import WorkerLostError
from catseye.app.cluster.share import name_item
from catseye.app.errors import ConfigError

try:
    from distributed import Client, Future, KilledWorker, wait
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

_PATIENCE = 15
"""After so many looks without any worker the work is given up; a busy machine takes ten seconds to restart one."""

_PACKAGES = ("catseye", "numpy", "scipy", "scikit-learn", "distributed")


class Machines:
    """Carries out items on the workers of a scheduler.

    Args:
        client: connection to the scheduler.
    """

    begins_after_s = 0.0

    def __init__(self, client: Client) -> None:
        self._client = client

    def map(
        self, function: Callable[[A], B], items: Sequence[A], done: Callable[[int], None] | None = None
    ) -> list[B]:
        """Carry out a function on each item; see Share."""
        # Not "pure": the scheduler would answer a repeated item from its memory.
        futures: list[Future[B]] = self._client.map(function, list(items), pure=False)
        numbers = {future: number for number, future in enumerate(futures, 1)}
        try:
            waiting = set(futures)
            while waiting:
                for future in self._next(waiting):
                    if not _has_ended(future, numbers[future], items):
                        continue
                    waiting.remove(future)
                    if done is not None:
                        done(len(items) - len(waiting))
            results: list[B] = self._client.gather(futures)
            return results
        finally:
            self._client.cancel(futures)

    def _next(self, waiting: set[Future[B]]) -> set[Future[B]]:
        """Wait for items, as long as there are workers.

        Raises:
            WorkerLostError: no worker is left, or the scheduler is gone.
        """
        looks_without = 0
        while looks_without < _PATIENCE:
            try:
                return set(wait(waiting, _LOOK_S, "FIRST_COMPLETED").done)
            except TimeoutError:
                alive = self._client.status == "running" and self._client.nthreads()
                looks_without = 0 if alive else looks_without + 1
            except CancelledError:
                break
        raise WorkerLostError(
            "no worker of the dask scheduler is left, or the scheduler itself is gone: start them and repeat"
        )


def _has_ended(future: Future[B], number: int, items: Sequence[object]) -> bool:
    """Tell whether there is a result; a worker that dies takes along what it had finished, and it begins anew.

    Raises:
        WorkerLostError: the item was given up with its workers.
        Exception: that of the item.
    """
    status = future.status
    if status not in ("error", "cancelled"):
        return bool(status == "finished")
    error = future.exception()
    if error is None or isinstance(error, KilledWorker):
        raise WorkerLostError(
            f"the dask workers lost item {number} of {len(items)} ({error or status}): look into their logs whether "
            "the memory did not suffice, and repeat"
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
        client = Client(address, timeout=_CONNECT_S)
    except (OSError, ValueError) as error:
        raise ConfigError(
            f"no dask scheduler answers at {address} within {_CONNECT_S:g} s ({error}): start one with "
            "`dask scheduler` and give the address that it prints, as tcp://HOST:8786"
        ) from error
    except TypeError as error:
        raise ConfigError(
            f"the dask scheduler at {address} cannot be asked ({error}): for TLS set "
            "DASK_DISTRIBUTED__COMM__TLS__CA_FILE, __CLIENT__CERT and __CLIENT__KEY behind the same beginning"
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
