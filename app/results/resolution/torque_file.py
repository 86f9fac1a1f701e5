"""Motor torque of a joint: CSV of this program, or a trace of a KUKA controller as `.dat` with `.r64` or as CSV."""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import numpy as np

from catseye.app.errors import UsageError
from catseye.app.files.columns import read_table
from catseye.app.files.diadem import Channel, read_trace
from catseye.app.files.foreign_csv import first_lines, found_dialect, read_numbers
from catseye.app.results.resolution.last_line import require_whole
from catseye.app.results.resolution.tables import TORQUE
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.resolution.errors import RecordingError
from catseye.calibration.resolution.torque import require_increasing
from catseye.drivers.roles.text_table import codec_of
from catseye.procedures.kit.columns import Columns

_TORQUE_UNITS: Final = frozenset({"nm", "n m", "n·m", "n*m"})
_TIME_UNITS: Final = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
_TIME_NAME: Final = re.compile(r"(t|time|zeit|zeitkanal)\b", re.IGNORECASE)
_HEADING: Final = re.compile(r"(.*?)\s*[\[(]([^\])]*)[\])]\s*")


def read_torque(path: Path, channel: str | None = None) -> Columns:
    """Read the motor torque of a joint.

    Args:
        path: of the file.
        channel: of a trace; without it, the only one in N m.

    Returns:
        Columns t_s and torque_nm.

    Raises:
        UsageError: the file cannot be used, its times do not increase, or which channel is meant is not clear; names
            the line, or what there is.
    """
    if path.suffix.lower() == ".r64":
        raise UsageError(
            f"{path}: holds the values of a KUKA trace and not what they are: state the .dat of the same name, with "
            "this file beside it"
        )
    torque = _read(path, channel)
    try:
        require_increasing(torque["t_s"])
    except RecordingError as error:
        line = torque.lines[(error.row or 1) - 1]
        place = f"{path}, row {line}" if path.suffix.lower() == ".dat" else f"{path}:{line}"
        raise UsageError(f"{place}: {error}") from error
    return torque


def _read(path: Path, channel: str | None) -> Columns:
    if path.suffix.lower() == ".dat":
        channels = read_trace(path)
        return _of_channels(path, channels, 1 + np.arange(channels[0].values.size), channel)
    own = channel is None and (path.suffix == ".parquet" or _has_own_header(path))
    torque = read_table(path, TORQUE) if own else _of_channels(path, *_csv_channels(path), channel)
    require_whole(path)
    return torque


def _has_own_header(path: Path) -> bool:
    lines = first_lines(path, codec_of("utf-8"), 100)
    return any("torque_nm" in line for line in lines if not line.startswith("#"))


def _csv_channels(path: Path) -> tuple[list[Channel], Ints]:
    """Return the channels of a trace as CSV, whose headings are `name(unit)`, and the line of each row."""
    dialect = found_dialect(path)
    above = first_lines(path, dialect.codec, dialect.header_lines)
    headings = next((dialect.cells(line) for line in reversed(above) if line.strip()), [])
    if not headings:
        raise UsageError(f"{path}: no line above the numbers names the columns; t_s,torque_nm is wanted")
    columns, lines = read_numbers(path, dialect, range(len(headings)))
    return [_headed(heading, values) for heading, values in zip(headings, columns, strict=True)], lines


def _headed(heading: str, values: Floats) -> Channel:
    found = _HEADING.fullmatch(heading)
    return Channel(heading, "", values) if found is None else Channel(found[1], found[2].strip(), values)


def _of_channels(path: Path, channels: Sequence[Channel], lines: Ints, name: str | None) -> Columns:
    time = _time_channel(path, channels)
    torque = _torque_channel(path, channels, name)
    if torque.values.size != time.values.size:
        raise UsageError(
            f"{path}: {torque.name} has {torque.values.size} values, {time.name} {time.values.size}: the trace is "
            "damaged; copy it from the controller again"
        )
    wrong = np.flatnonzero(~np.isfinite(torque.values))
    if wrong.size:
        raise UsageError(
            f"{path}: {torque.name} has no value in row {wrong[0] + 1}: trace again, or cut the trace"
        )
    return Columns(
        {"t_s": time.values * _TIME_UNITS[time.unit.lower() or "s"], "torque_nm": torque.values},
        lines,
    )


def _time_channel(path: Path, channels: Sequence[Channel]) -> Channel:
    for one in channels:
        if _TIME_NAME.match(one.name) and (one.unit.lower() or "s") in _TIME_UNITS:
            return one
    for one in channels:
        if one.unit.lower() in _TIME_UNITS:
            return one
    raise UsageError(f"{path}: no channel holds times; there are {_listed(channels)}")


def _torque_channel(path: Path, channels: Sequence[Channel], name: str | None) -> Channel:
    if name is not None:
        meant = [one for one in channels if one.name == name]
    else:
        meant = [one for one in channels if one.unit.lower() in _TORQUE_UNITS]
    if len(meant) == 1:
        return meant[0]
    problem = f"{len(meant)} channels are in N m" if name is None else f"no single channel is called {name!r}"
    raise UsageError(f"{path}: {problem}; name one by --torque-channel; there are {_listed(channels)}")


def _listed(channels: Sequence[Channel]) -> str:
    return ", ".join(f"{one.name} [{one.unit}]" if one.unit else one.name for one in channels)
