"""Ports of this machine at which nothing listens."""

import contextlib
import socket

TEMPLATE_PORTS = (10001, 10002, 10502, 10099)
"""Of the devices in the template of a cell file, in its order."""


def free_ports(count: int) -> list[int]:
    """Return ports that were free just now, all different."""
    with contextlib.ExitStack() as stack:
        sockets = [stack.enter_context(socket.socket()) for _ in range(count)]
        for one in sockets:
            one.bind(("127.0.0.1", 0))
        return [int(one.getsockname()[1]) for one in sockets]


def free_port() -> int:
    """Return a port that was free just now."""
    return free_ports(1)[0]


def at_ports(ports: list[int]) -> list[tuple[str, str]]:
    """Return what to replace in the template, and by what, so that its devices are at these ports."""
    return [(f"127.0.0.1:{old}", f"127.0.0.1:{new}") for old, new in zip(TEMPLATE_PORTS, ports, strict=True)]
