"""Which dask schedulers are connected to: whoever reaches one runs programs on all machines that share its work."""

import ipaddress
from urllib.parse import urlsplit

from catseye.app.errors import ConfigError

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
