"""Work shared over processes of this machine."""

import multiprocessing
import os
import pickle
import signal
import threading
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.connection import Connection
from typing import TypeVar

from catseye.app.cluster.errors import WorkerLostError
from catseye.app.cluster.share import name_item

A = TypeVar("A")
B = TypeVar("B")

_ONE_THREAD = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
"""Each process has a core to itself: threads of the linear algebra would only wait for one another."""


_BEGINS_AFTER_S = 2.0
"""What a new process takes to import what the work needs: 1.2 s of a core, and starting it."""


class Processes:
    """Carries out items in a pool of processes."""

    begins_after_s = _BEGINS_AFTER_S

    def __init__(self, pool: ProcessPoolExecutor) -> None:
        self._pool = pool

    def map(
        self, function: Callable[[A], B], items: Sequence[A], done: Callable[[int], None] | None = None
    ) -> list[B]:
        """Carry out a function on each item; see Share.

        Items that wait when one fails end with the pool: it cannot end items that are cancelled already.
        """
        futures: dict[Future[B], int] = {}
        try:
            with _uninterrupted():
                for number, item in enumerate(items, 1):
                    futures[self._pool.submit(_carry_out, function, item)] = number
            for count, future in enumerate(as_completed(futures), 1):
                _raise_with_item(future, futures[future], items)
                if done is not None:
                    done(count)
        except BrokenProcessPool as error:
            raise WorkerLostError(
                f"a worker process ended before its item was finished ({error}): it was killed, or the memory did "
                "not suffice; repeat, with fewer --workers if memory is short"
            ) from error
        return [future.result() for future in futures]


def _carry_out(function: Callable[[A], B], item: A) -> B:
    """Call a function in a worker; an error that cannot travel is replaced by one that can."""
    try:
        return function(item)
    except Exception as error:
        try:
            pickle.loads(pickle.dumps(error))
        except Exception as reason:  # noqa: BLE001  # whatever the error's own class raises
            raise RuntimeError(f"{type(error).__name__}: {error} (which cannot travel: {reason})") from None
        raise


def _raise_with_item(future: Future[B], number: int, items: Sequence[object]) -> None:
    error = future.exception()
    if error is None:
        return
    if not isinstance(error, BrokenProcessPool):
        name_item(error, number, items)
    raise error


@contextmanager
def processes(workers: int) -> Iterator[Processes]:
    """Provide so many processes, which end with the context or with this process, however it ends."""
    spawn = multiprocessing.get_context("spawn")
    held_by_workers, held_here = spawn.Pipe(duplex=False)
    pool = ProcessPoolExecutor(workers, spawn, _end_with, (held_by_workers,))
    with held_by_workers, held_here, _environment(_ONE_THREAD):
        try:
            yield Processes(pool)
        finally:
            # Closing this end ends the workers at once, also in the midst of an item.
            held_here.close()
            # A worker that ends while it sends leaves half a result: with this end open its rest would be waited for.
            # The pool itself offers no other way.
            pool._result_queue._writer.close()  # type: ignore[attr-defined]  # noqa: SLF001  # not in its stubs
            pool.shutdown(cancel_futures=True)


@contextmanager
def _uninterrupted() -> Iterator[None]:
    """Hold Ctrl-C back meanwhile; a process that is started here never hears it, from its first instruction on."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _end_with(lifeline: Connection) -> None:
    """Tie a worker's life to the other end of a pipe."""

    def watch() -> None:
        lifeline.poll(None)
        os._exit(0)

    threading.Thread(target=watch, daemon=True).start()


@contextmanager
def _environment(values: dict[str, str]) -> Iterator[None]:
    """Set environment variables that processes started meanwhile take over."""
    before = {name: os.environ.get(name) for name in values}
    os.environ.update(values)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
