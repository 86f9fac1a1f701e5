"""A running engine with a thousand hostile connections at once: STOP gets through, and its memory stays flat.

`CATSEYE_CONNECTIONS` sets how many, `CATSEYE_SEED` repeats what they say; both are printed.
"""

import contextlib
import json
import os
import random
import resource
import signal
import socket
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.fuzz.amount import source, tell
from tests.fuzz.requests import hostile_line, request
from tests.patience import HANG_S
from tests.system.command import begun, emulated, own_runtime
from tests.system.memory import resident_mb
from tests.system.socket_client import Lines

CONNECTIONS = int(os.environ.get("CATSEYE_CONNECTIONS", "1000"))
MOST_GROWTH_MB = 20.0
DEEP = b"[" * 60_000 + b"\n"
HUGE = b"x" * 300_000


def _hostile(numbers: random.Random) -> bytes:
    """Return what a connection says, its line unended where it goes on slowly."""
    match numbers.randrange(6):
        case 0:
            return DEEP
        case 1:
            return HUGE
        case 2:
            return b""
        case 3:
            return request({"op": "hello", "client": "hostile", "who": "Eve"}) + hostile_line(numbers)
        case 4:
            return request({"op": "ping"}).rstrip()
        case _:
            return b"".join(hostile_line(numbers) for _ in range(20))


@contextlib.contextmanager
def _crowd(path: str, numbers: random.Random) -> Iterator[list[socket.socket]]:
    """Connect all, and have each say something; whoever is let go meanwhile stays away."""
    crowd: list[socket.socket] = []
    try:
        while len(crowd) < CONNECTIONS:
            client = socket.socket(socket.AF_UNIX)
            client.settimeout(0.05)
            crowd.append(client)
            with contextlib.suppress(OSError):
                client.connect(path)
                client.sendall(_hostile(numbers))
        yield crowd
    finally:
        for client in crowd:
            client.close()


def _dribble(crowd: list[socket.socket]) -> None:
    """Send a byte on each connection that is left: a line that never ends."""
    for client in crowd:
        with contextlib.suppress(OSError):
            client.send(b"x")


def _asked(ada: Lines, path: str) -> tuple[float, float]:
    """Return how long a known client and a stranger waited for the answers to ping and STOP, s."""
    begin_s = time.monotonic()
    assert ada.ask("ping")["ok"]
    ping_s = time.monotonic() - begin_s
    begin_s = time.monotonic()
    with contextlib.closing(Lines(path)) as stranger:
        answer = stranger.ask("stop")
        # It is carried out at once; where nothing is under way it says so.
        assert answer["ok"] or "no run" in answer["error"], answer
    return ping_s, time.monotonic() - begin_s


@pytest.mark.timeout(3600)
def test_a_thousand_hostile_connections_shut_nobody_out(tmp_path: Path) -> None:
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    assert max(soft, hard) > CONNECTIONS + 100
    resource.setrlimit(resource.RLIMIT_NOFILE, (max(soft, min(hard, CONNECTIONS + 200)), hard))
    numbers = source("connections")
    with (
        own_runtime(),
        emulated(tmp_path) as bench,
        begun("engine", "--cell", bench.cell, cwd=tmp_path) as (engine, output),
    ):
        path = json.loads(output.readline())["socket"]
        with contextlib.closing(Lines(path)) as ada:
            assert ada.ask("hello", client="test", who="Ada")["ok"]
            with _crowd(path, numbers):
                _asked(ada, path)
            before_mb, waits = resident_mb(engine.pid), []
            for _ in range(5):
                with _crowd(path, numbers) as crowd:
                    _dribble(crowd)
                    waits.append(_asked(ada, path))
            growth_mb = resident_mb(engine.pid) - before_mb
            assert ada.ask("ping")["ok"]
        engine.send_signal(signal.SIGTERM)
        assert engine.wait(HANG_S) in {0, 143}
    pings, stops = zip(*waits, strict=True)
    tell(
        f"5 crowds of {CONNECTIONS} connections: longest ping {max(pings):.2f} s, STOP {max(stops):.2f} s, "
        f"engine {growth_mb:+.1f} MB"
    )
    assert growth_mb < MOST_GROWTH_MB
