"""The guard: a process that says STOP when the engine dies, or falls silent while the arm moves.

Standard library only, imports nothing of ours, so that it starts in milliseconds and has little that can fail. Called
as `python -I -S guard.py DESCRIPTOR PID`; the descriptor is one end of a SOCK_SEQPACKET pair, the engine has the
other, and its process number is for whoever lists the processes.
Each message is one packet of words:

engine → guard `own ARM`, with the descriptors of the log and of the owner's locks · `protect NAME HEX`, with the
    descriptor of an open connection and the bytes that stop the arm on it · `release NAME` · `beat 0|1`: the loop is
    alive, and whether a motion is under way · `understood`: nothing moves before an acknowledgement · `end`
guard → engine `alive SECONDS`, its own monotonic time, after each beat · `released NAME` · `stopped UTC WHY`
"""

import contextlib
import os
import select
import signal
import socket
import sys
import time

SILENCE_S = 0.5
"""A loop that gives no beat for so long while a motion is under way is stopped."""

TICK_S = 0.02
_LONGEST_TICK_S = 0.1
_IDLE_S = 1.0
_REPEAT_S = 0.1
_CONFIRM_S = 1.2
"""STOP is repeated for so long after the engine has died: one that meets a full buffer is lost."""

_LATER_REPEAT_S = 1.0
_MESSAGE_BYTES = 65_536
_MOST_DESCRIPTORS = 16
_DRAINED_BYTES = 65_536
_IGNORED = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT", "SIGTSTP", "SIGTTIN", "SIGTTOU", "SIGPIPE", "SIGUSR1")

DIED = "the program that moved it ended without giving it back"
SILENT = f"the program that moved it did not answer for {SILENCE_S:g} s"


class Ended(Exception):  # noqa: N818  # the engine's own word, no error
    """The engine has given the arm back."""


class Silence:
    """How long the loop has been silent, counted only while this process itself was running.

    A machine that stands still, or gives this process no time, makes nobody late: when it goes on, the beat that
    waits is read first, and a tick that took longer counts as a short one.
    """

    def __init__(self) -> None:
        self.moving = False
        self.elapsed_s = 0.0

    def beat(self, *, moving: bool) -> None:
        """Take a sign of life."""
        self.moving, self.elapsed_s = moving, 0.0

    def passed(self, elapsed_s: float) -> bool:
        """Count a tick in which nothing came; return whether the silence is too long for a motion."""
        self.elapsed_s += min(elapsed_s, _LONGEST_TICK_S)
        return self.moving and self.elapsed_s >= SILENCE_S


class Connection:
    """A duplicate of an open connection, and the bytes that stop the arm on it."""

    def __init__(self, descriptor: int, stop: bytes) -> None:
        self.descriptor = descriptor
        self._stop = stop

    def write_stop(self) -> None:
        """Write STOP unless the connection is broken or takes nothing; never waits."""
        if self._ready(select.POLLOUT):
            with contextlib.suppress(OSError):
                os.write(self.descriptor, self._stop)

    def drain(self) -> None:
        """Throw away what has come, a bounded part of it: answers that nobody reads must not block the other side."""
        if self._ready(select.POLLIN):
            with contextlib.suppress(OSError):
                os.read(self.descriptor, _DRAINED_BYTES)

    def close(self) -> None:
        """Let the connection go."""
        os.close(self.descriptor)

    def _ready(self, event: int) -> bool:
        poll = select.poll()
        poll.register(self.descriptor, event)
        return any(found & event for _, found in poll.poll(0))


class Guard:
    """Watches one engine.

    Args:
        engine: this side of the pair.
    """

    def __init__(self, engine: socket.socket) -> None:
        # Not by a flag: recv_fds of some versions of Python ignores it.
        engine.setblocking(False)
        self._engine = engine
        self._poll = select.poll()
        self._poll.register(engine, select.POLLIN)
        self._silence = Silence()
        self._connections: dict[str, Connection] = {}
        self._arm = "?"
        self._log: int | None = None
        self._locks: list[int] = []
        self._stopped_s: float | None = None
        self._next_stop_s = 0.0

    def watch(self) -> None:
        """Watch until the engine gives the arm back or dies."""
        with contextlib.suppress(Ended):
            while True:
                begun_s = time.monotonic()
                waits = self._silence.moving or self._stopped_s is not None
                self._poll.poll(1e3 * (TICK_S if waits else _IDLE_S))
                # What waits to be read counts before the time that has passed.
                if not self._read():
                    self._mourn()
                    return
                if self._silence.passed(time.monotonic() - begun_s) and self._stopped_s is None:
                    self._stopped_s = time.monotonic()
                    self._stop(SILENT)
                self._stop_again()

    def _read(self) -> bool:
        """Take every message that has come; return whether the engine lives.

        Raises:
            Ended: it has given the arm back.
        """
        while True:
            try:
                data, descriptors, _, _ = socket.recv_fds(self._engine, _MESSAGE_BYTES, _MOST_DESCRIPTORS)
            except (BlockingIOError, InterruptedError):
                return True
            except OSError:
                return False
            if not data:
                return False
            self._take(data.decode().split(" "), descriptors)

    def _take(self, words: list[str], descriptors: list[int]) -> None:
        match words:
            case ["beat", moving]:
                self._silence.beat(moving=moving == "1")
                self._say(f"alive {time.monotonic()!r}")
            case ["own", arm]:
                self._arm = arm
                self._log, *self._locks = descriptors
            case ["protect", name, stop]:
                self._release(name)
                self._connections[name] = Connection(descriptors[0], bytes.fromhex(stop))
            case ["release", name]:
                self._release(name)
                self._say(f"released {name}")
            case ["understood"]:
                self._stopped_s = None
            case ["end"]:
                raise Ended

    def _release(self, name: str) -> None:
        if name in self._connections:
            self._connections.pop(name).close()

    def _stop(self, why: str) -> None:
        """Tell the engine first, which may wake up just now and then sends no motion; then write STOP and log it."""
        utc = time.strftime("%Y-%m-%dT%H:%M:%SZ", time.gmtime())
        self._say(f"stopped {utc} {why}")
        self._write_stop()
        moved = "a motion was under way" if self._silence.moving else "no motion was known to be under way"
        self._note(f"{utc} {why}; {moved}")

    def _write_stop(self) -> None:
        for connection in self._connections.values():
            connection.write_stop()
        # A motion that the engine wrote at the very moment is stopped by the next one.
        again_s = _REPEAT_S if self._stopped_for_s() < _CONFIRM_S else _LATER_REPEAT_S
        self._next_stop_s = time.monotonic() + again_s

    def _stop_again(self) -> None:
        if self._stopped_s is not None and time.monotonic() >= self._next_stop_s:
            self._write_stop()

    def _stopped_for_s(self) -> float:
        return 0.0 if self._stopped_s is None else time.monotonic() - self._stopped_s

    def _mourn(self) -> None:
        """Stop the arm of an engine that has died, again and again for a moment; the lock is held until then."""
        self._stopped_s = time.monotonic()
        self._stop(DIED)
        while self._stopped_for_s() < _CONFIRM_S:
            time.sleep(TICK_S)
            for connection in self._connections.values():
                connection.drain()
            self._stop_again()

    def _say(self, text: str) -> None:
        # An engine that reads nothing, or has gone, is told nothing.
        with contextlib.suppress(OSError):
            self._engine.send(text.encode())

    def _note(self, text: str) -> None:
        """Leave what was done in the log, and in the owner's locks for whoever takes the arm next."""
        with contextlib.suppress(OSError):
            if self._log is not None:
                os.write(self._log, f"{text} arm={self._arm} guard={os.getpid()}\n".encode())
        for lock in self._locks:
            with contextlib.suppress(OSError):
                os.pwrite(lock, f"stopped={text}\n".encode(), os.fstat(lock).st_size)


def main() -> None:
    """Watch the engine at the descriptor that the command line names."""
    for name in _IGNORED:
        signal.signal(getattr(signal, name), signal.SIG_IGN)
    with socket.socket(fileno=int(sys.argv[1])) as engine:
        Guard(engine).watch()


if __name__ == "__main__":
    main()
