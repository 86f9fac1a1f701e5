"""Append-only files of JSON lines: the wire transcript and the application's log."""

import logging
import os
from collections import Counter
from collections.abc import Callable, Mapping
from io import FileIO
from pathlib import Path
from typing import Final

from catseye.app.store.rows import to_json
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Entry
from catseye.procedures.kit.records import Json

DEFAULT_MAX_BYTES = 64 * 1024 * 1024
HEALS: Final = "links_healed"
"""Key of the closing record: how often the links of each device were healed since the run began or went on."""


class JsonLines:
    """A file of JSON lines, each written at once, bounded in size.

    Writing never raises: a stop must reach the robot even when the disk is full. A failure is handed over
    instead, and lines beyond the bound are counted.

    Args:
        path: the file; appended to when it exists.
        clock: stamps the lines.
        on_failure: called when the disk refuses a line.
        max_bytes: where the file is cut.
    """

    def __init__(
        self,
        path: Path,
        clock: Clock,
        on_failure: Callable[[OSError], None],
        max_bytes: int = DEFAULT_MAX_BYTES,
    ) -> None:
        self._file = _opened(path)
        self._path = path
        self._half = _ends_in_half_a_line(self._file)
        self._clock = clock
        self._on_failure = on_failure
        self._free = max_bytes - self._file.tell()
        self._full = False
        self.cut_lines = 0
        self.cut_bytes = 0

    def write(self, **fields: Json) -> None:
        """Append a line with the time and these fields; after `close` it does nothing."""
        self._append(self._line(fields))

    def _line(self, fields: Mapping[str, Json]) -> bytes:
        return to_json({"t": self._clock.now_utc().isoformat(), **fields}).encode() + b"\n"

    def _append(self, line: bytes) -> None:
        if self._file.closed:
            return
        if self._full or len(line) > self._free:
            self._full = True
            self._cut(line)
            return
        if self._half:
            # Whoever reads line by line would take the rest of an older line and this one for one.
            line = b"\n" + line
        self._free -= len(line)
        try:
            taken = self._file.write(line) or 0
            if taken == len(line):
                self._half = False
            else:
                self._half = not line[:taken].endswith(b"\n") if taken else self._half
                raise OSError(f"{self._path} took only a part of a line; the disk is full")
        except OSError as error:
            self._on_failure(error)

    def _cut(self, line: bytes) -> None:
        self.cut_lines += 1
        self.cut_bytes += len(line)

    def close(self) -> None:
        """Close the file; may be called any number of times."""
        self._file.close()


def _opened(path: Path) -> FileIO:
    """Open a file for appending, unbuffered: a line that was written survives the death of the process."""
    # A link would lead to a file that is not the run's.
    flags = os.O_RDWR | os.O_APPEND | os.O_CREAT | os.O_CLOEXEC | os.O_NOFOLLOW
    return FileIO(os.open(path, flags, 0o666), "ab")


def _ends_in_half_a_line(file: FileIO) -> bool:
    size_bytes = os.fstat(file.fileno()).st_size
    return size_bytes > 0 and os.pread(file.fileno(), 1, size_bytes - 1) != b"\n"


_PRINTABLE = bytes(byte if 32 <= byte < 127 else ord(".") for byte in range(256))


_MOST_OF_ONE = 0.5
"""Share of the transcript that one device may fill: a stream must not push the others out."""


class WireLog(JsonLines):
    """What went over the wires.

    Args:
        path: the file; appended to when it exists.
        clock: stamps the lines.
        on_failure: called when the disk refuses a line.
        max_bytes: where the file is cut.

    Attributes:
        heals: how often the links of each device were healed.
    """

    def __init__(
        self,
        path: Path,
        clock: Clock,
        on_failure: Callable[[OSError], None],
        max_bytes: int = DEFAULT_MAX_BYTES,
    ) -> None:
        super().__init__(path, clock, on_failure, max_bytes)
        self._share_bytes = int(_MOST_OF_ONE * max_bytes)
        self._used_bytes: dict[str, int] = {}
        self.heals: Counter[str] = Counter()

    def record(self, device: str, entry: Entry, data: bytes) -> None:
        """Keep bytes, or why a link is healed.

        Args:
            device: its name in the cell file, such as robot; a stream of its own has a name of its own.
            entry: what the line holds; its `direction` in the file.
            data: the bytes, as they went, or the text.
        """
        if entry == "heal":
            self.heals[device] += 1
        text = data.translate(_PRINTABLE).decode("ascii")
        line = self._line({"device": device, "direction": entry, "hex": data.hex(), "text": text})
        used_bytes = self._used_bytes.get(device, 0) + len(line)
        self._used_bytes[device] = used_bytes
        if used_bytes > self._share_bytes:
            self._cut(line)
            return
        self._append(line)


class LogHandler(logging.Handler):
    """Writes log records into a file of JSON lines."""

    def __init__(self, lines: JsonLines) -> None:
        super().__init__(logging.INFO)
        self._lines = lines
        self.setFormatter(logging.Formatter("%(message)s"))

    def emit(self, record: logging.LogRecord) -> None:
        """Write a record, with the traceback of an exception."""
        self._lines.write(level=record.levelname, logger=record.name, text=self.format(record))
