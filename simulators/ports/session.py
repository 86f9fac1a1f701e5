"""What an emulated device says to one client. Sessions know bytes; ports know sockets and lines.

A session carries out one request after the other, in order. What takes bench time is a `Pending` answer; requests
that come meanwhile wait.
"""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True)
class Pending:
    """An answer that is due later.

    Attributes:
        due: bench time to wait for, None when the answer is due; see `TimeKeeper.wait`.
        reply: makes the answer.
    """

    due: Callable[[], float | None]
    reply: Callable[[], bytes]


Answer = bytes | Pending
"""What a session says to one request; empty bytes: nothing."""


class Session:
    """One client's conversation. Bytes go in, answers come out; no socket, no clock.

    On a datagram port each call of `feed` brings one datagram and each answer and output leaves as one; elsewhere
    bytes come cut anywhere.
    """

    def feed(self, data: bytes) -> None:
        """Take what the client sent."""
        raise NotImplementedError

    @property
    def deaf(self) -> bool:
        """Nothing more is read while an earlier request waits for its answer."""
        return False

    @property
    def over(self) -> bool:
        """The connection ends behind the last answer."""
        return False

    def overtake(self) -> None:
        """Look at what was fed last while an earlier request still waits for its answer."""

    def answer(self) -> Answer | None:
        """Carry out the next complete request and answer it; None when there is none."""
        raise NotImplementedError

    def silence_s(self) -> float | None:
        """Return the real time, s, after which silence completes what has come; None: silence means nothing."""
        return None

    def idle(self) -> None:
        """Take note that the client was silent for that time."""

    def next_output_s(self) -> float | None:
        """Return the bench time of the next unrequested output, None for none."""
        return None

    def output(self) -> bytes:
        """Return the unrequested output that is due."""
        return b""

    def close(self) -> None:
        """Take note that the client is gone."""
