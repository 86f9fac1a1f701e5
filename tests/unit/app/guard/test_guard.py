"""What the guard writes and where, seen through the descriptors that it was given."""

import os
import socket
import time
from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

import pytest

from catseye.app.guard import guard
from catseye.app.guard.guard import DIED, Connection, Guard

STOP = b"\r1;1;STOP\r"


class Pair:
    """Both ends of a guard's pair."""

    def __init__(self) -> None:
        self.ours, self.theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)

    def say(self, text: str, *descriptors: int) -> None:
        socket.send_fds(self.ours, [text.encode()], descriptors)

    def watched_to_the_end(self) -> None:
        """Let the engine die, and the guard see it."""
        self.ours.close()
        self.watched()

    def watched(self) -> None:
        """Have the guard watch until the arm is given back or the engine has died."""
        before = set(os.listdir("/proc/self/fd"))
        try:
            Guard(self.theirs, os.getpid()).watch()
        finally:
            # What its process's end would close.
            for descriptor in set(os.listdir("/proc/self/fd")) - before:
                with suppress(OSError):
                    os.close(int(descriptor))


@pytest.fixture
def pair(monkeypatch: pytest.MonkeyPatch) -> Iterator[Pair]:
    monkeypatch.setattr(guard, "_CONFIRM_S", 0.05)
    monkeypatch.setattr(guard, "_REPEAT_S", 0.0)
    made = Pair()
    with made.ours, made.theirs:
        yield made


@pytest.fixture
def pipe() -> Iterator[tuple[int, int]]:
    source, sink = os.pipe()
    yield source, sink
    os.close(source)
    os.close(sink)


def test_what_it_did_stands_in_the_lock_without_a_log(pair: Pair, tmp_path: Path) -> None:
    path = tmp_path / "lock"
    path.write_text("pid=1\n", encoding="ascii")
    with path.open("r+b") as lock:
        pair.say("own arm 1", lock.fileno())
        pair.watched_to_the_end()
    owner, stopped = path.read_text(encoding="ascii").splitlines()
    assert owner == "pid=1"
    assert stopped.startswith("stopped=")
    assert DIED in stopped


def test_it_logs_after_the_last_stop(pair: Pair, pipe: tuple[int, int]) -> None:
    source, sink = pipe
    # A log on a disk that hangs would take the connection's turn too.
    pair.say(f"protect robot {STOP.hex()}", sink)
    pair.say("log", sink)
    pair.watched_to_the_end()
    stops, _, log = os.read(source, 65_536).rpartition(STOP)
    assert stops.count(STOP) >= 1
    assert DIED.encode() in log


@pytest.mark.parametrize("text", ["own arm 2", "own an arm 1", "protect robot", "log 1", "what"])
def test_a_message_that_it_cannot_read_ends_it(pair: Pair, pipe: tuple[int, int], text: str) -> None:
    pair.say(text, pipe[1])
    with pytest.raises(ValueError, match="is no message"):
        pair.watched_to_the_end()


def test_more_descriptors_than_agreed_end_it(pair: Pair, pipe: tuple[int, int]) -> None:
    count = 17
    pair.say(f"own arm {count}", *[pipe[1]] * count)
    with pytest.raises(ValueError, match="descriptors"):
        pair.watched_to_the_end()


def test_an_arm_that_was_given_back_is_not_stopped(pair: Pair, pipe: tuple[int, int]) -> None:
    source, sink = pipe
    pair.say(f"protect robot {STOP.hex()}", sink)
    pair.say("end")
    pair.watched_to_the_end()
    os.set_blocking(source, False)
    with pytest.raises(BlockingIOError):
        os.read(source, 1)


def test_a_partial_write_of_the_stop_does_not_block(pipe: tuple[int, int]) -> None:
    source, sink = pipe
    room = 4096
    Connection(sink, b"\r" * 2 * room).write_stop()
    written = len(os.read(source, 1 << 20))
    # Until the pipe is full to the last byte: the last writes are partial or refused, and return.
    for _ in range(1000):
        Connection(sink, b"\r" * (room + 1)).write_stop()
    assert written == 2 * room


class StoppedTime:
    """Passes with each look at it until the first STOP, which the engine understands; stands still then.

    Args:
        pair: whose engine gives the arm back in the end.
    """

    def __init__(self, pair: Pair) -> None:
        self.stops = 0
        self._pair = pair
        self._now_s = 0.0
        self._looks = 0

    def monotonic(self) -> float:
        if not self.stops:
            self._now_s += 0.1
        else:
            self._looks += 1
            if self._looks == 20:
                self._pair.say("end")
        return self._now_s

    def clock_gettime(self, _clock: int) -> float:
        return 0.0

    def gmtime(self) -> time.struct_time:
        return time.gmtime(0)

    def strftime(self, text: str, _when: time.struct_time) -> str:
        self.stops += 1
        self._pair.say("understood")
        return text


def test_an_engine_that_has_understood_is_not_stopped_once_more(
    pair: Pair, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its next beat comes behind that word."""
    passing = StoppedTime(pair)
    monkeypatch.setattr(guard, "time", passing)
    pair.say("beat 1")
    pair.watched()
    assert passing.stops == 1
