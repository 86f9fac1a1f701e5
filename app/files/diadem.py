"""Traces of KUKA controllers: a DIAdem header (`.dat`) and its values (`.r64`) beside it.

Source: the project's sheet of KUKA interfaces, section A3. Values are rows of doubles, one for each explicit channel;
a value is raw · (241) + (240). Key 112 is `High -> Low` as PCs write it, `Low -> High` for exchanged bytes.
"""

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.column_rules import LARGEST_NUMBER
from catseye.app.files.csv_lines import named_faults
from catseye.calibration.core.types import Floats
from catseye.drivers.roles.text_table import plain_digits
from catseye.drivers.roles.user_file import read_regular

_NO_VALUE: Final = 111
_BYTE_ORDER: Final = 112
_NAME: Final = 200
_UNIT: Final = 202
_KIND: Final = 210
_FILE: Final = 211
_STORAGE: Final = 213
_TYPE: Final = 214
_COUNT: Final = 220
_COLUMN: Final = 221
_OFFSET: Final = 240
_FACTOR: Final = 241

_KEY: Final = re.compile(r"[0-9]{1,9}")

_KINDS: Final = {"EXPLIZIT": True, "EXPLICIT": True, "IMPLIZIT": False, "IMPLICIT": False}
_BYTE_ORDERS: Final = {"High -> Low": "<f8", "Low -> High": ">f8"}
_LARGEST_BYTES: Final = 1 << 30
_AGAIN: Final = "copy both files of the trace from the controller again"


@dataclass(frozen=True)
class Channel:
    """One channel of a trace.

    Attributes:
        name: as the controller calls it.
        unit: without brackets; empty for none.
        values: NaN where there is none, shape (n,).
    """

    name: str
    unit: str
    values: Floats


@dataclass(frozen=True)
class _Header:
    """One header of the `.dat`: values by key, and the lines they stand in."""

    path: Path
    line: int
    values: Mapping[int, str]

    def text(self, key: int, default: str | None = None) -> str:
        found = self.values.get(key, default)
        if found is None:
            raise self.fault(f"key {key} is missing")
        return found.strip()

    def number(self, key: int, default: str | None = None) -> float:
        text = self.text(key, default)
        try:
            value = float(plain_digits(text))
        except ValueError as error:
            raise self.fault(f"key {key} holds {text!r}, no number") from error
        if not abs(value) <= LARGEST_NUMBER and key != _NO_VALUE:
            raise self.fault(f"key {key} holds {text!r}, which no trace has")
        return value

    def count(self, key: int) -> int:
        value = self.number(key)
        if not 1.0 <= value <= _LARGEST_BYTES / 8 or value != int(value):
            raise self.fault(f"key {key} is {value:g}, no count")
        return int(value)

    def fault(self, text: str) -> UsageError:
        return UsageError(f"{self.path}:{self.line}: the header that begins here: {text}; {_AGAIN}")


def read_trace(path: Path) -> list[Channel]:
    """Read a trace by its header.

    Args:
        path: of the `.dat`; the files that it names stand beside it.

    Raises:
        UsageError: a file is missing, damaged, cut off or of another kind; names the line or the counts.
    """
    found = list(_headers(path))
    if not found:
        raise UsageError(f"{path}: has no header of a KUKA trace; {_AGAIN}")
    whole, *headers = found
    if not headers:
        raise UsageError(f"{path}: the header names no channel; {_AGAIN}")
    order = _BYTE_ORDERS.get(whole.text(_BYTE_ORDER, "High -> Low"))
    if order is None:
        raise whole.fault(f"key {_BYTE_ORDER} is neither {' nor '.join(_BYTE_ORDERS)}")
    blocks = _Blocks(path, order, headers)
    stored = {header.line: blocks.column(header) for header in headers if _is_explicit(header)}
    none = whole.number(_NO_VALUE, "nan")
    return [_channel(header, stored, none) for header in headers]


class _Blocks:
    """Tables of values by the name of their file.

    Args:
        path: of the header.
        order: type of the values.
        headers: of all channels.
    """

    def __init__(self, path: Path, order: str, headers: list[_Header]) -> None:
        self._path, self._order = path, order
        self._columns: dict[str, int] = {}
        for header in headers:
            if _is_explicit(header):
                file = header.text(_FILE)
                self._columns[file] = self._columns.get(file, 0) + 1
        self._read: dict[str, Floats] = {}

    def column(self, header: _Header) -> Floats:
        """Return the raw values of an explicit channel, shape (n,)."""
        for key, wanted in ((_STORAGE, "BLOCK"), (_TYPE, "REAL64")):
            if header.text(key) != wanted:
                raise header.fault(f"key {key} is {header.text(key)}, a trace has {wanted}")
        file, count, place = header.text(_FILE), header.count(_COUNT), header.count(_COLUMN)
        columns = self._columns[file]
        if place > columns:
            raise header.fault(f"key {_COLUMN} is {place}, but {columns} channels stand in {file}")
        values = self._values(file)
        if values.size != count * columns:
            raise UsageError(
                f"{self._path.parent / file}: holds {values.size} values, but {count} rows of {columns} channels are "
                f"{count * columns}: it is cut off or of another trace; {_AGAIN}"
            )
        return values[place - 1 :: columns]

    def _values(self, file: str) -> Floats:
        if file not in self._read:
            raw = _partner(self._path, file)
            if len(raw) % 8:
                raise UsageError(
                    f"{self._path.parent / file}: its {len(raw)} bytes are not a whole number of values: it is cut "
                    f"off; {_AGAIN}"
                )
            self._read[file] = np.frombuffer(raw, self._order).astype(np.float64)
        return self._read[file]


def _partner(path: Path, file: str) -> bytes:
    # The header was written on Windows: its path is the controller's, and the case of letters may differ.
    name = file.replace("\\", "/").rpartition("/")[2]
    beside = next((one for one in path.parent.iterdir() if one.name.lower() == name.lower()), None)
    if beside is None:
        raise UsageError(f"{path}: its values are in {name}, which does not stand beside it; {_AGAIN}")
    with named_faults(beside):
        return read_regular(beside, _LARGEST_BYTES)


def _channel(header: _Header, stored: Mapping[int, Floats], none: float) -> Channel:
    offset, factor = header.number(_OFFSET, "0"), header.number(_FACTOR, "1")
    if (raw := stored.get(header.line)) is not None:
        with np.errstate(over="ignore", invalid="ignore"):
            values = np.where(raw == none, np.nan, raw * factor + offset)
        if (wrong := np.flatnonzero(np.abs(values) > LARGEST_NUMBER)).size:
            raise header.fault(f"value {wrong[0] + 1} is {values[wrong[0]]:g}, which no trace has")
    else:
        values = np.arange(_counted(header, stored)) * factor + offset
    return Channel(header.text(_NAME), header.text(_UNIT, "").strip("[]() "), values)


def _counted(header: _Header, stored: Mapping[int, Floats]) -> int:
    """Return how many values a channel has that is counted: no more than stand in a file."""
    count, longest = header.count(_COUNT), max((raw.size for raw in stored.values()), default=0)
    if count > longest:
        raise header.fault(
            f"key {_COUNT} is {count}, but no file holds more than {longest} values of a channel"
        )
    return count


def _is_explicit(header: _Header) -> bool:
    kind = header.text(_KIND)
    if kind not in _KINDS:
        raise header.fault(f"key {_KIND} is {kind!r}, neither {' nor '.join(_KINDS)}")
    return _KINDS[kind]


def _headers(path: Path) -> Iterator[_Header]:
    """Yield the global header, then one a channel."""
    with named_faults(path):
        lines = read_regular(path).decode("latin-1").splitlines()
    if not lines or not lines[0].startswith("DIAEXTENDED"):
        raise UsageError(
            f"{path}: does not begin with DIAEXTENDED: this is not a header of a KUKA trace; {_AGAIN}"
        )
    begin, values = 0, dict[int, str]()
    for number, line in enumerate(lines[1:], 2):
        text = line.strip()
        if text.startswith("#BEGIN"):
            begin, values = number, {}
        elif text.startswith("#END"):
            yield _Header(path, begin, values)
            begin = 0
        elif begin and text:
            key, comma, value = text.partition(",")
            if not comma or not _KEY.fullmatch(key.strip()):
                raise UsageError(f"{path}:{number}: {text!r} is not a key with a value; {_AGAIN}")
            values.setdefault(int(key), value)
    if begin:
        raise UsageError(
            f"{path}:{begin}: the header that begins here does not end: the file is cut off; {_AGAIN}"
        )
