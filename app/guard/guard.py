"""The guard: a process that says STOP when the engine dies, or falls silent while the arm moves.

Standard library only, imports nothing of ours, so that it starts in milliseconds and has little that can fail. Called
as `python -I -S guard.py DESCRIPTOR PID`; the descriptor is one end of a SOCK_SEQPACKET pair, the engine has the
other, and its process number: its end counts also while a child of it keeps the pair open.
Each message is one packet of words:

engine → guard `own ARM COUNT`, with the descriptors of so many locks of the owner · `log`, with that of the log ·
    `protect NAME HEX`, with the descriptor of an open connection and the bytes that stop the arm on it ·
    `release NAME` · `beat 0|1`: the loop is alive, and whether a motion is under way · `understood`: nothing moves
    before an acknowledgement · `end`
guard → engine `alive SECONDS SECONDS`, its own monotonic time and `boot_s`, after each beat · `released NAME` ·
    `stopped UTC WHY`

What it cannot read ends it, which the engine takes as it takes its death.
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

FROZEN_S = 1.0
"""Where this process itself stood still for so long while a motion was under way nobody watched anything."""

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
FROZEN = f"program and guard, or this machine, stood still for more than {FROZEN_S:g} s"
SILENT = f"the program that moved it did not answer for {SILENCE_S:g} s"


_CLOCK = getattr(time, "CLOCK_BOOTTIME", time.CLOCK_MONOTONIC)


def boot_s() -> float:
    """Return a time that goes on while the machine is suspended, where the system has such a one."""
    return time.clock_gettime(_CLOCK)


class Ended(Exception):  # noqa: N818  # the engine's own word, no error
    """The engine has given the arm back."""


class Silence:
    """How long the loop has been silent, counted only while this process itself was running.

    A machine that gives this process no time for a moment makes nobody late: when it goes on, the beat that waits
    is read first, and a tick that took longer counts as a short one.
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
        # The drivers have it so already; a line that takes a part of STOP only would hold this process up.
        os.set_blocking(descriptor, False)
        self.descriptor = descriptor
        self._stop = stop

    def write_stop(self) -> None:
        """Write STOP unless the connection is broken or takes nothing; never waits.

        Of one that takes a part only the rest is not sent: the next one begins with the end of a request.
        """
        if _is_ready(self.descriptor, select.POLLOUT):
            with contextlib.suppress(OSError):
                os.write(self.descriptor, self._stop)

    def drain(self) -> None:
        """Throw away what has come, a bounded part of it: answers that nobody reads must not block the other side."""
        if _is_ready(self.descriptor, select.POLLIN):
            with contextlib.suppress(OSError):
                os.read(self.descriptor, _DRAINED_BYTES)

    def close(self) -> None:
        """Let the connection go."""
        os.close(self.descriptor)


def _is_ready(descriptor: int, event: int) -> bool:
    poll = select.poll()
    poll.register(descriptor, event)
    return any(found & event for _, found in poll.poll(0))


def _life_of(pid: int) -> int | None:
    """Return a descriptor that can be read once a process has ended; None where the system has no such thing."""
    with contextlib.suppress(OSError, AttributeError):
        return os.pidfd_open(pid)
    return None


class Guard:
    """Watches one engine.

    Args:
        pid: number of the engine's process.
    """

    def __init__(self, engine: socket.socket, pid: int) -> None:
        # Not by a flag: recv_fds of some versions of Python ignores it.
        engine.setblocking(False)
        self._engine = engine
        self._poll = select.poll()
        self._poll.register(engine, select.POLLIN)
        self._life = _life_of(pid)
        if self._life is not None:
            self._poll.register(self._life, select.POLLIN)
        self._silence = Silence()
        self._counted_s = time.monotonic()
        self._awake_s = boot_s()
        self._connections: dict[str, Connection] = {}
        self._arm = "?"
        self._log: int | None = None
        self._locks: list[int] = []
        self._unlogged = ""
        self._stopped_s: float | None = None
        self._next_stop_s = 0.0

    def watch(self) -> None:
        """Watch until the engine gives the arm back or dies."""
        with contextlib.suppress(Ended):
            while self._lives():
                if self._is_silent():
                    self._stop_once(SILENT)
                self._stop_again()
                if self._stopped_s is None or self._stopped_for_s() > _CONFIRM_S:
                    self._write_log()
            self._mourn()
        self._write_log()

    def _lives(self) -> bool:
        """Wait for a tick or a message; return whether the engine lives, whose messages have been taken.

        Raises:
            Ended: it has given the arm back.
        """
        waits = self._silence.moving or self._stopped_s is not None
        self._poll.poll(1e3 * (TICK_S if waits else _IDLE_S))
        # Said before any answer to a beat: whoever thaws sooner than this process sends no motion after it.
        if self._has_stood_still() and self._silence.moving:
            self._stop_once(FROZEN)
        # Asked first: its last words count.
        has_ended = self._life is not None and _is_ready(self._life, select.POLLIN)
        return self._read() and not has_ended

    def _has_stood_still(self) -> bool:
        now_s = boot_s()
        elapsed_s, self._awake_s = now_s - self._awake_s, now_s
        return elapsed_s > FROZEN_S

    def _is_silent(self) -> bool:
        """Return whether nothing has come for too long: what waits to be read counts before the time that passed."""
        now_s = time.monotonic()
        elapsed_s, self._counted_s = now_s - self._counted_s, now_s
        return self._silence.passed(elapsed_s)

    def _read(self) -> bool:
        """Take every message that has come; return whether the engine lives.

        Raises:
            Ended: it has given the arm back.
        """
        while True:
            try:
                data, descriptors, flags, _ = socket.recv_fds(self._engine, _MESSAGE_BYTES, _MOST_DESCRIPTORS)
            except (BlockingIOError, InterruptedError):
                return True
            except OSError:
                return False
            if not data:
                return False
            if flags & (socket.MSG_CTRUNC | socket.MSG_TRUNC):
                raise ValueError("a message is longer, or brings more descriptors, than is agreed")
            self._take(data.decode().split(" "), descriptors)

    def _take(self, words: list[str], descriptors: list[int]) -> None:
        match words:
            case ["beat", moving]:
                self._silence.beat(moving=moving == "1")
                self._counted_s = time.monotonic()
                self._say(f"alive {self._counted_s!r} {boot_s()!r}")
            case ["own", arm, count] if int(count) == len(descriptors):
                self._arm, self._locks = arm, descriptors
            case ["log"]:
                (self._log,) = descriptors
            case ["protect", name, stop]:
                (descriptor,) = descriptors
                self._release(name)
                self._connections[name] = Connection(descriptor, bytes.fromhex(stop))
            case ["release", name]:
                self._release(name)
                self._say(f"released {name}")
            case ["understood"]:
                self._stopped_s = None
                # It is a sign of life, and the beat behind it may be yet to come.
                self._silence.beat(moving=self._silence.moving)
                self._counted_s = time.monotonic()
            case ["end"]:
                raise Ended
            case _:
                raise ValueError(f"{words[0]} with {len(descriptors)} descriptors is no message")

    def _release(self, name: str) -> None:
        if name in self._connections:
            self._connections.pop(name).close()

    def _stop_once(self, why: str) -> None:
        if self._stopped_s is None:
            self._stopped_s = time.monotonic()
            self._stop(why)

    def _stop(self, why: str) -> None:
        """Notify the engine, which may just wake up and then sends no motion; then write STOP and note it."""
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
        # An engine that reads nothing, or has gone, is not notified.
        with contextlib.suppress(OSError):
            self._engine.send(text.encode())

    def _note(self, text: str) -> None:
        """Leave what was done in the owner's locks for whoever takes the arm next; the log has it later."""
        self._unlogged += f"{text} arm={self._arm} guard={os.getpid()}\n"
        for lock in self._locks:
            with contextlib.suppress(OSError):
                os.pwrite(lock, f"stopped={text}\n".encode(), os.fstat(lock).st_size)

    def _write_log(self) -> None:
        """Log what was done, after all that stops the arm: what blocked the engine may be the disk that logs."""
        text, self._unlogged = self._unlogged, ""
        with contextlib.suppress(OSError):
            if text and self._log is not None:
                os.write(self._log, text.encode())


def main() -> None:
    """Watch the engine at the descriptor that the command line names."""
    for name in _IGNORED:
        signal.signal(getattr(signal, name), signal.SIG_IGN)
    with socket.socket(fileno=int(sys.argv[1])) as engine:
        Guard(engine, int(sys.argv[2])).watch()


if __name__ == "__main__":
    main()
