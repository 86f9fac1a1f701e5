"""The choice of who carries out shared work: this process, processes of this machine, or other machines."""

import os
from collections.abc import Iterator
from contextlib import contextmanager

from catseye.app.cluster.share import InThisProcess, Share
from catseye.app.cluster.trust import require_trusted


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
