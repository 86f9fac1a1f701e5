"""A transport that plays a conversation of the past: for tests of drivers without their instrument.

A transcript is a list of (direction, bytes). One can be written by hand from a manual, or be read from the `wire.log`
of a run by `load_transcript`:

    steps = load_transcript(Path("run/wire.log"), "interferometer")
    counter = LineCounter(ReplayTransport(steps), clock, profile)

What a driver sends has to be what was sent then, byte for byte; how the bytes are cut into writes does not matter.
What came then comes again, in the same chunks, as soon as everything before it has been sent.
"""

import asyncio
import json
from collections import deque
from collections.abc import Iterable
from pathlib import Path

from catseye.drivers.roles.device import Direction
from catseye.drivers.roles.errors import LinkError
from catseye.drivers.roles.user_file import read_regular

Step = tuple[Direction, bytes]

LARGEST_TRANSCRIPT_BYTES = 128 * 1024 * 1024
"""Runs cut theirs at half of this."""

_SHOWN_BYTES = 16


class DeviationError(Exception):
    """A driver does not send what the transcript has. No device error: no driver may swallow it or try again."""


class ReplayTransport:
    """Plays the device of a transcript."""

    def __init__(self, steps: Iterable[Step], *, endpoint: str = "replay://transcript") -> None:
        self._steps = deque((direction, data) for direction, data in steps if data)
        self._endpoint = endpoint
        self._came: deque[bytes] = deque()
        self._is_open = False
        self._sent_bytes = 0
        self._progress = asyncio.Event()

    @property
    def endpoint(self) -> str:
        """The name given."""
        return self._endpoint

    @property
    def finished(self) -> bool:
        """Whether everything has been sent and read."""
        return not self._steps and not self._came

    async def open(self) -> None:
        """Open; a link that is opened again goes on where the transcript stands."""
        self._is_open = True
        self._advance()

    async def close(self) -> None:
        """Close; may be called any number of times."""
        self._is_open = False
        self._progress.set()

    async def write(self, data: bytes) -> None:
        """Compare with what was sent then.

        Raises:
            DeviationError: other bytes, or more of them; the text shows both, aligned.
            LinkError: the link is closed.
        """
        self.send_urgent(data)

    def note_heal(self, why: str) -> None:
        """Note nothing: no transcript is kept here."""
        del why

    def fileno(self) -> int:
        """Refuse: there is none.

        Raises:
            LinkError: always.
        """
        raise LinkError(f"{self._endpoint}: a transcript has no descriptor")

    def send_urgent(self, data: bytes, *, cut: bytes = b"") -> None:
        """Compare with what was sent then; nothing ever waits here, so nothing is cut.

        Raises:
            DeviationError: other bytes, or more of them; the text shows both, aligned.
            LinkError: the link is closed.
        """
        del cut
        self._require_open()
        rest = data
        while rest:
            expected = self._steps[0][1] if self._steps else b""
            count = min(len(expected), len(rest))
            if not count or rest[:count] != expected[:count]:
                raise DeviationError(self._difference(rest, expected))
            self._steps.popleft()
            if expected[count:]:
                self._steps.appendleft(("tx", expected[count:]))
            rest = rest[count:]
            self._sent_bytes += count
            self._advance()

    async def read(self) -> bytes:
        """Return the next chunk; wait while the transcript has something to be sent first.

        Raises:
            LinkError: the link is closed, or the transcript has ended.
        """
        while not (chunk := self.waiting()):
            if not self._steps:
                raise LinkError(f"{self._endpoint}: the transcript has ended: nothing more came then")
            self._progress.clear()
            await self._progress.wait()
        return chunk

    def waiting(self) -> bytes:
        """Return a chunk that has come, empty bytes when nothing has.

        Raises:
            LinkError: the link is closed.
        """
        self._require_open()
        return self._came.popleft() if self._came else b""

    def _advance(self) -> None:
        """Let come what came before the next bytes were sent."""
        while self._steps and self._steps[0][0] == "rx":
            self._came.append(self._steps.popleft()[1])
        self._progress.set()

    def _require_open(self) -> None:
        if not self._is_open:
            raise LinkError(f"{self._endpoint}: the link is closed: open it first")

    def _difference(self, sent: bytes, expected: bytes) -> str:
        same = next(
            (i for i, pair in enumerate(zip(sent, expected, strict=False)) if pair[0] != pair[1]),
            min(len(sent), len(expected)),
        )
        start = max(0, same - _SHOWN_BYTES // 2)
        mark = " " * (3 * (same - start)) + "^^"
        return (
            f"{self._endpoint}: byte {self._sent_bytes + same} differs from the transcript:\n"
            f"  sent      {_shown(sent[start:])}\n"
            f"  expected  {_shown(expected[start:]) if expected else 'nothing more'}\n"
            f"            {mark}"
        )


def load_transcript(path: Path, device: str = "") -> list[Step]:
    """Read the bytes of one device from JSON lines with `direction`, `hex` and perhaps `device`.

    Lines that name a healing of the link are left out.

    Args:
        path: the `wire.log` of a run, or a file like it.
        device: its name; empty takes every line.

    Raises:
        OSError: the file is missing, no regular one, or too large.
        ValueError: a line is none; the text names file and line.
    """
    steps: list[Step] = []
    raw = read_regular(path, LARGEST_TRANSCRIPT_BYTES)
    for number, line in enumerate(raw.splitlines(), 1):
        try:
            row = json.loads(line)
            direction, data = row["direction"], bytes.fromhex(row["hex"])
        except (ValueError, KeyError, TypeError, RecursionError) as exc:
            raise ValueError(f"{path}:{number}: not a line of a transcript ({exc})") from None
        if direction not in ("tx", "rx", "heal"):
            raise ValueError(f"{path}:{number}: direction has to be tx, rx or heal, not {direction!r}")
        # A healing only says of the bytes around it why they passed.
        if device in {"", row.get("device")} and direction != "heal":
            steps.append((direction, data))
    return steps


def _shown(data: bytes) -> str:
    part = data[:_SHOWN_BYTES]
    text = "".join(chr(byte) if 32 <= byte < 127 else "." for byte in part)
    return f"{part.hex(' '):<{3 * _SHOWN_BYTES}} |{text}|"
