"""Requests of all clients of a server are carried out one after the other, and each takes its time.

What has come is carried out even where its client is gone.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from catseye.simulators.ports.session import Pending
from catseye.simulators.world.timed_bench import TimedBench

_SHORTEST_S, _LONGEST_S = 0.005, 0.015


@dataclass
class _Turn:
    """A request that waits for its turn.

    Attributes:
        due_s: bench time at which it is carried out.
        answer: its reply, None before.
    """

    due_s: float
    answer: bytes | None = None

    def due(self) -> float | None:
        """Return the bench time to wait for, None once it was carried out."""
        return self.due_s if self.answer is None else None

    def reply(self) -> bytes:
        """Return the reply of a request that was carried out."""
        return self.answer or b""


class Turns:
    """What the clients of one server share: a request takes 5 to 15 ms of bench time.

    Args:
        bench: whose time it lives in.
        seed: of how long requests take.
    """

    def __init__(self, bench: TimedBench, *seed: int) -> None:
        self._bench = bench
        self._delays = np.random.default_rng(seed)
        self._busy_until_s = -math.inf

    @property
    def busy(self) -> bool:
        """A request is being carried out, or waits for its turn."""
        return self._bench.time_s < self._busy_until_s

    def take(self, carry_out: Callable[[], bytes]) -> Pending:
        """Have a request carried out in its turn; return what waits for its reply."""
        took_s = float(self._delays.uniform(_SHORTEST_S, _LONGEST_S))
        self._busy_until_s = max(self._busy_until_s, self._bench.time_s) + took_s
        turn = _Turn(self._busy_until_s)
        self._bench.call_at(turn.due_s, partial(_finish, turn, carry_out))
        return Pending(turn.due, turn.reply)


def _finish(turn: _Turn, carry_out: Callable[[], bytes]) -> None:
    turn.answer = carry_out()
