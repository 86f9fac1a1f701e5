"""A transport that goes wrong on request: for tests of drivers, with any other transport inside.

    link = FaultyTransport(inner, [Fault(3, "drop"), Fault(5, "split")])     # scripted
    link = FaultyTransport(inner, random_faults(seed=7), note="seed 7")      # the note stands in every error text

Chunks are counted from 0 in each direction, over all connections. What a driver has to bear:

==============  ========================================================================================
split           the chunk comes in two pieces
coalesce        the chunk waits for the next one, at most `amount_s`, and comes together with it
delay           the chunk comes `amount_s` later, and all that follows behind it
drop            the chunk is lost
duplicate       the chunk comes twice
corrupt         a bit of the chunk's middle byte is flipped: `mask`, by default the highest bit
stall           from here on nothing passes in either direction
half-close      behind the chunk the other side sends no more; it still listens
late            the chunk comes only after the next request, or never if the link is opened again before
foreign         behind the chunk comes `data`, an answer to somebody else's question
==============  ========================================================================================

Chunks that are sent know `split`, `delay`, `drop` and `stall`. A new connection ends `stall` and `half-close`.

What no driver of a protocol without check sums and numbers can notice, and what a test must therefore not ask for:
a corrupted digit that is another digit (a `mask` of 1), a part of a number that is lost, and an answer of the right
shape that comes in place of the right one.
"""

import asyncio
import math
import random
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, get_args

from catseye.drivers.links.transport import Transport, WrappedTransport
from catseye.drivers.roles.device import Direction
from catseye.drivers.roles.errors import LinkError

Kind = Literal[
    "split", "coalesce", "delay", "drop", "duplicate", "corrupt", "stall", "half-close", "late", "foreign"
]

KINDS: tuple[Kind, ...] = get_args(Kind)
SENT_KINDS: tuple[Kind, ...] = ("split", "delay", "drop", "stall")


@dataclass(frozen=True)
class Fault:
    """What happens to one chunk.

    Attributes:
        at: number of the chunk in its direction.
        kind: see the module.
        direction: tx is sent, rx is received.
        amount_s: how long, for delay and coalesce, real s.
        mask: which bits are flipped, for corrupt.
        data: what comes, for foreign.
    """

    at: int
    kind: Kind
    direction: Direction = "rx"
    amount_s: float = 0.05
    mask: int = 0x80
    data: bytes = b""

    def __post_init__(self) -> None:
        if self.direction == "tx" and self.kind not in SENT_KINDS:
            raise ValueError(f"a chunk that is sent cannot have {self.kind!r}, only {', '.join(SENT_KINDS)}")


def random_faults(seed: int, *, chunks: int = 1000, rate: float = 0.1) -> list[Fault]:
    """Return faults of every kind but foreign, spread at random over the first chunks of both directions.

    Args:
        chunks: how many chunks of each direction.
        rate: how many of them have a fault, 0...1.
    """
    source = random.Random(seed)
    directions: tuple[tuple[Direction, tuple[Kind, ...]], ...] = (("rx", KINDS[:-1]), ("tx", SENT_KINDS))
    return [
        Fault(at, source.choice(kinds), direction, amount_s=source.uniform(0.0, 0.1))
        for at in range(chunks)
        for direction, kinds in directions
        if source.random() < rate
    ]


@dataclass
class _Chunk:
    """What has come from inside and was not delivered."""

    data: bytes
    due_s: float
    takes_more: bool = False


class FaultyTransport(WrappedTransport):
    """Makes a transport go wrong.

    Args:
        faults: what goes wrong; of several for one chunk the last one counts.
        note: stands behind the endpoint in texts, such as the seed of random faults.
    """

    def __init__(self, inner: Transport, faults: Iterable[Fault], *, note: str = "") -> None:
        super().__init__(inner)
        self._faults = {(fault.direction, fault.at): fault for fault in faults}
        self._note = note
        self._counts: dict[Direction, int] = {"tx": 0, "rx": 0}
        self._chunks: deque[_Chunk] = deque()
        self._stalled = False
        self._half_closed = False
        self._closed = asyncio.Event()

    @property
    def endpoint(self) -> str:
        """Where it leads, with the note."""
        return f"{self._inner.endpoint} ({self._note})" if self._note else self._inner.endpoint

    async def open(self) -> None:
        """Connect.

        Raises:
            LinkError: unreachable.
        """
        self._closed.clear()
        await self._inner.open()

    async def close(self) -> None:
        """Disconnect; what was under way is gone. May be called any number of times."""
        self._chunks.clear()
        self._stalled = self._half_closed = False
        self._closed.set()
        await self._inner.close()

    async def write(self, data: bytes) -> None:
        """Send all bytes, unless a fault has it otherwise.

        Raises:
            LinkError: the link is closed.
        """
        fault = self._next("tx")
        kind: Kind | Literal[""] = fault.kind if fault else ""
        if fault and kind == "delay":
            await asyncio.sleep(fault.amount_s)
        if self._swallows(kind):
            return
        half = len(data) // 2 if kind == "split" else 0
        if half:
            await self._inner.write(data[:half])
        await self._inner.write(data[half:])
        self._release_late()

    def send_urgent(self, data: bytes, *, cut: bytes = b"") -> None:
        """Send bytes past what waits; a fault may lose them, and neither splits nor delays them.

        Raises:
            LinkError: the link is closed or takes no bytes.
        """
        fault = self._next("tx")
        if not self._swallows(fault.kind if fault else ""):
            self._inner.send_urgent(data, cut=cut)
            self._release_late()

    async def read(self) -> bytes:
        """Return the next chunk.

        Raises:
            LinkError: the other side has closed the link.
        """
        while not (data := self._due()):
            wait_s = self._chunks[0].due_s - asyncio.get_running_loop().time() if self._chunks else math.inf
            try:
                async with asyncio.timeout(None if math.isinf(wait_s) else wait_s):
                    self._receive(await self._from_inside())
            except TimeoutError:
                continue
        return data

    def waiting(self) -> bytes:
        """Return a chunk that has come, empty bytes when nothing has.

        Raises:
            LinkError: the other side has closed the link.
        """
        while not self._stalled and not self._half_closed and (data := self._inner.waiting()):
            self._receive(data)
        data = self._due()
        if not data and self._half_closed:
            raise self._other_side_closed()
        return data

    async def _from_inside(self) -> bytes:
        if self._half_closed:
            raise self._other_side_closed()
        if not self._stalled:
            return await self._inner.read()
        await self._closed.wait()
        raise LinkError(f"{self.endpoint}: the link was closed: open it again")

    def _next(self, direction: Direction) -> Fault | None:
        at = self._counts[direction]
        self._counts[direction] += 1
        return self._faults.get((direction, at))

    def _swallows(self, kind: Kind | Literal[""]) -> bool:
        self._stalled |= kind == "stall"
        return self._stalled or kind == "drop"

    def _release_late(self) -> None:
        """Let come what a fault keeps until the next request."""
        now_s = asyncio.get_running_loop().time()
        for chunk in self._chunks:
            if math.isinf(chunk.due_s):
                chunk.due_s = now_s

    def _due(self) -> bytes:
        """Return the oldest chunk if its time has come."""
        if self._chunks and self._chunks[0].due_s <= asyncio.get_running_loop().time():
            return self._chunks.popleft().data
        return b""

    def _receive(self, data: bytes) -> None:
        """Line up what has come from inside, as its fault has it."""
        fault = self._next("rx")
        now_s = asyncio.get_running_loop().time()
        match fault.kind if fault else "":
            case "split" if len(data) > 1:
                half = len(data) // 2
                self._line_up(data[:half], now_s)
                self._line_up(data[half:], now_s)
            case "coalesce" if fault:
                self._line_up(data, now_s + fault.amount_s)
                self._chunks[-1].takes_more = True
            case "delay" if fault:
                self._line_up(data, now_s + fault.amount_s)
            case "drop":
                return
            case "duplicate":
                self._line_up(data, now_s)
                self._line_up(data, now_s)
            case "corrupt" if fault:
                middle = len(data) // 2
                flipped = bytes([data[middle] ^ fault.mask])
                self._line_up(data[:middle] + flipped + data[middle + 1 :], now_s)
            case "stall":
                self._stalled = True
            case "half-close":
                self._line_up(data, now_s)
                self._half_closed = True
            case "late":
                self._line_up(data, math.inf)
            case "foreign" if fault:
                self._line_up(data, now_s)
                self._line_up(fault.data, now_s)
            case _:
                self._line_up(data, now_s)

    def _line_up(self, data: bytes, due_s: float) -> None:
        last = self._chunks[-1] if self._chunks else None
        if last and last.takes_more:
            last.data, last.takes_more, last.due_s = last.data + data, False, min(last.due_s, due_s)
        elif data:
            self._chunks.append(_Chunk(data, due_s))

    def _other_side_closed(self) -> LinkError:
        return LinkError(f"{self.endpoint}: the other side has closed the link: open it again")
