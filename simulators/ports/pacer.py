"""The byte time of a serial line: what is put in comes out byte by byte, in small chunks."""

import asyncio
from collections.abc import Callable

_TICK_S = 0.002
"""Timers of the event loop are not finer than a millisecond; at high rates a tick carries several bytes."""


class Pacer:
    """One direction of a serial line.

    Args:
        byte_s: returns the real time of one byte, s.
        deliver: takes the bytes whose time is over.
        capacity_bytes: how much may be under way; what comes beyond is lost, as in the buffer of a real port.
    """

    def __init__(
        self, byte_s: Callable[[], float], deliver: Callable[[bytes], None], capacity_bytes: int
    ) -> None:
        self._byte_s = byte_s
        self._deliver = deliver
        self._capacity_bytes = capacity_bytes
        self._under_way = bytearray()
        self._passed_s = 0.0
        self._timer: asyncio.TimerHandle | None = None
        self.lost_bytes = 0

    @property
    def room_bytes(self) -> int:
        """How much more may be put in."""
        return self._capacity_bytes - len(self._under_way)

    @property
    def gap_s(self) -> float:
        """Longest real time between two chunks, s."""
        return max(self._byte_s(), _TICK_S)

    def put(self, data: bytes) -> None:
        """Put bytes on the line."""
        taken = data[: self.room_bytes]
        self.lost_bytes += len(data) - len(taken)
        if taken and not self._under_way:
            self._passed_s = max(self._passed_s, asyncio.get_running_loop().time())
        self._under_way += taken
        self._set_timer()

    def clear(self) -> None:
        """Forget what is under way."""
        self._under_way.clear()
        if self._timer is not None:
            self._timer.cancel()
            self._timer = None

    def _set_timer(self) -> None:
        if self._under_way and self._timer is None:
            loop = asyncio.get_running_loop()
            first_s = self._passed_s + self._byte_s()
            self._timer = loop.call_at(max(first_s, min(loop.time() + _TICK_S, self._end_s())), self._tick)

    def _end_s(self) -> float:
        return self._passed_s + len(self._under_way) * self._byte_s()

    def _tick(self) -> None:
        self._timer = None
        byte_s = self._byte_s()
        # The clock of the loop calls a timer up to its resolution early.
        now_s = asyncio.get_running_loop().time() + 1e-6
        count = min(int((now_s - self._passed_s) / byte_s), len(self._under_way))
        self._passed_s += count * byte_s
        chunk = bytes(self._under_way[:count])
        del self._under_way[:count]
        self._set_timer()
        if chunk:
            self._deliver(chunk)
