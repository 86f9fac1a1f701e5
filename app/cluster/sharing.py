"""The choice of who carries out shared work: this process, processes of this machine, or other machines."""

import ipaddress
import os
from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import urlsplit

from catseye.app.cluster.share import InThisProcess, Share
from catseye.app.errors import ConfigError


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


_ENCRYPTED = frozenset({"tls", "wss"})


def require_trusted(address: str, *, insecure: bool) -> None:
    """Refuse a scheduler on the network that anybody there could command.

    Args:
        address: of the scheduler, SCHEME://HOST:PORT; without a scheme it is tcp.
        insecure: the user has said that everybody on the network is trusted.

    Raises:
        ConfigError: the scheduler is outside of this machine, and the connection is without TLS.
    """
    try:
        parts = urlsplit(address if "://" in address else f"tcp://{address}")
        host = parts.hostname or ""
    except ValueError as error:
        raise ConfigError(f"--dask {address}: {error}; give the address as tcp://HOST:8786") from error
    if insecure or parts.scheme in _ENCRYPTED or _is_this_machine(host):
        return
    raise ConfigError(
        f"--dask {address}: without TLS everybody on the network can run programs on the machines that share the "
        "work, this one too: start scheduler and workers with --tls-ca-file, --tls-cert and --tls-key, and give the "
        "address as tls://HOST:8786; on a network on which you trust everybody, add --insecure-cluster"
    )


def _is_this_machine(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
