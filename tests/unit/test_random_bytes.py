"""Nonsense and mutated traffic: drivers raise ProtocolError only, emulators nothing, and nobody hangs or grows.

A third of the bytes is drawn at random, a third are pieces of what the protocol says, in any order, and a third are
valid messages with changes. `make campaign-fuzz` feeds ten million bytes to each codec.
"""

import tracemalloc
from collections.abc import Callable, Iterator, Sequence

import pytest

from catseye.simulators.emulator import emulator_names
from tests.fuzz.amount import BYTES, source, tell
from tests.fuzz.decoders import DECODERS
from tests.fuzz.mutation import mutated
from tests.fuzz.sessions import CONTROL, served

LONGEST_CHUNK = 700
WATCHED_BYTES = 100_000
"""So many bytes at the end are fed while memory is traced, which makes everything several times slower."""
MOST_HELD_BYTES = 50_000
"""More than any buffer of a codec; one that keeps half of the watched bytes, as they are or as objects, holds it."""


def nonsense(name: str, pieces: Sequence[bytes], valid: Sequence[bytes]) -> Iterator[bytes]:
    """Yield bytes for one codec in chunks of any length."""
    numbers, left = source(name), BYTES
    while left > 0:
        size = numbers.choice((1, 2, 7, 60, LONGEST_CHUNK))
        match numbers.randrange(3):
            case 0 if pieces:
                chunk = b"".join(numbers.choices(pieces, k=size // 4 + 1))[:LONGEST_CHUNK]
            case 1 if valid:
                chunk = mutated(numbers.choice(valid), numbers, valid)
            case _:
                chunk = numbers.randbytes(numbers.randint(1, size))
        left -= len(chunk)
        yield chunk


def survive(feed: Callable[[bytes], None], chunks: Iterator[bytes]) -> None:
    """Feed all chunks and see that hardly anything of them is kept."""
    fed_bytes = 0
    while fed_bytes < BYTES - WATCHED_BYTES:
        chunk = next(chunks)
        feed(chunk)
        fed_bytes += len(chunk)
    last = list(chunks)
    tracemalloc.start()
    try:
        for chunk in last:
            feed(chunk)
        held, _ = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert held < MOST_HELD_BYTES


@pytest.mark.parametrize("protocol", DECODERS)
def test_no_bytes_break_a_driver(protocol: str) -> None:
    tried = DECODERS[protocol]
    survive(tried.make(), nonsense(protocol, tried.pieces, tried.valid))
    tell(f"driver {protocol}: {BYTES} bytes")


SOCKET, LINE = "tcp://127.0.0.1:0", "serial:///dev/ptmx"
OTHER_ON_A_LINE = ("melfa-r3", "modbus-air")
"""Protocols that frame their requests in another way on a serial line."""


@pytest.mark.parametrize(
    ("protocol", "endpoint"),
    [(name, SOCKET) for name in (*emulator_names(), CONTROL)] + [(name, LINE) for name in OTHER_ON_A_LINE],
)
def test_no_bytes_break_an_emulator(protocol: str, endpoint: str) -> None:
    session = served(protocol, endpoint)
    survive(session.feed, nonsense(protocol + endpoint, session.pieces, session.valid))
    session.close()
    tell(f"emulator {protocol} at {endpoint}: {BYTES} bytes")
