"""Series of stored runs: the readings of their recordings on one time axis, with the moves that were commanded."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, Final

import numpy as np

from catseye.app.store.reader import RunReader
from catseye.calibration.core.types import Floats
from catseye.procedures.resolution.records import Configuration, Move

_BLOCKS: Final = 40
_IN_BLOCK: Final = 50
"""In each of so many parts of a stream, none shorter than this, some value arrives as soon as it can."""

_FEWEST_BLOCKS: Final = 4
"""Fewer would not tell missing values from another interval."""

_ROUNDS: Final = 3
"""Of narrowing down the interval of a stream; the second one changes it by less than its error already."""


@dataclass(frozen=True)
class RecordedSeries:
    """One series of a run.

    Attributes:
        name: of its step, for file names.
        configuration: row of the table of `catseye.procedures.resolution.records.Configuration`.
        recording: row of the table of `catseye.procedures.kit.recording.Recorded`.
        time_s: of the readings, s since the recording's origin, shape (n,).
        displacement_mm: corrected for the air, shape (n,).
        moves: rows of the table of `catseye.procedures.resolution.records.Move`, in order.
    """

    name: str
    configuration: Mapping[str, Any]
    recording: Mapping[str, Any]
    time_s: Floats
    displacement_mm: Floats
    moves: tuple[Mapping[str, Any], ...]

    @property
    def unit(self) -> str:
        """Of steps and positions: deg or mm."""
        return str(self.configuration["unit"])

    def command(self) -> Floats:
        """Return the signed sizes of the moves, deg or mm, shape (m,)."""
        return np.array([move["command"] for move in self.moves], dtype=np.float64)

    def move_time_s(self) -> Floats:
        """Return when the moves were sent, s since the recording's origin, shape (m,)."""
        return np.array([move["time_s"] for move in self.moves], dtype=np.float64)

    def torque_time_s(self) -> Floats:
        """Return when the torques were read, behind each dwell, s since the recording's origin, shape (m,)."""
        dwell_s = float(self.configuration["dwell_s"])
        times_s = [move.get("torque_s") for move in self.moves]
        # Runs of earlier versions did not note it.
        read_s = [
            move["ended_s"] + dwell_s if time_s is None else time_s
            for move, time_s in zip(self.moves, times_s, strict=True)
        ]
        return np.array(read_s, dtype=np.float64)

    def torque_nm(self) -> Floats | None:
        """Return the motor torques of the tested axis, shape (m,); None where the controller states none."""
        torques = [move["torque_nm"] for move in self.moves]
        return None if None in torques else np.array(torques, dtype=np.float64)


def series_of_run(reader: RunReader) -> Iterator[RecordedSeries]:
    """Yield the whole series of a run; those that were cut short or left out are none.

    Raises:
        StorageError: readings are missing or are not what was written.
    """
    recordings = {_key(row, "name"): row for row in reader.recordings()}
    moves: dict[tuple[Any, ...], list[Mapping[str, Any]]] = {}
    for row in reader.rows(Move.table):
        moves.setdefault(_key(row, "recording"), []).append(row)
    for configuration in reader.rows(Configuration.table):
        key = _key(configuration, "recording")
        yield _series(reader, configuration, recordings[key], tuple(moves.get(key, ())))


def _key(row: Mapping[str, Any], name: str) -> tuple[Any, ...]:
    return row["step_id"], row["attempt"], row[name]


def _series(
    reader: RunReader,
    configuration: Mapping[str, Any],
    recording: Mapping[str, Any],
    moves: tuple[Mapping[str, Any], ...],
) -> RecordedSeries:
    chunks = list(reader.chunks(recording))
    empty = np.empty(0)
    time_s = np.concatenate([empty, *(np.frombuffer(chunk.times_s) for chunk in chunks)])
    raw_mm = np.concatenate([empty, *(np.frombuffer(chunk.values) for chunk in chunks)])
    return RecordedSeries(
        str(configuration["step_id"]).replace("/", "-").replace("--", "-minus").replace("-+", "-plus"),
        configuration,
        recording,
        _times(recording, time_s),
        float(recording["scale"]) * raw_mm + float(recording["offset_mm"]),
        moves,
    )


def _times(recording: Mapping[str, Any], arrival_s: Floats) -> Floats:
    """Return when the readings of a recording were taken."""
    if recording["method"] != "streamed":
        return arrival_s
    complete = bool(recording["numbered"]) and not recording["values_lost"]
    return sent_times(arrival_s, complete=complete)


def sent_times(arrival_s: Floats, *, complete: bool = False) -> Floats:
    """Return when the values of a stream were sent, by when they arrived.

    An instrument sends at its own steady rate; links and programs deliver late and in bunches, never early. So the
    earliest arrivals lie on a straight line over their numbers. Where they do not, values are missing: then the times
    of arrival are returned as they are, and whoever needs a uniform rate finds the gap.

    Args:
        arrival_s: shape (n,).
        complete: no value is missing, as the instrument's own numbers show, however late some arrived.
    """
    if arrival_s.size < _FEWEST_BLOCKS * _IN_BLOCK:
        return arrival_s
    number = np.arange(arrival_s.size)
    interval_s = float(arrival_s[-1] - arrival_s[0]) / (arrival_s.size - 1)
    for _ in range(_ROUNDS):
        first, late_s = _earliest(arrival_s - interval_s * number)
        interval_s += _usual_slope(first, late_s)
    _, late_s = _earliest(arrival_s - interval_s * number)
    if not complete and np.ptp(late_s) > interval_s / 2.0:
        return arrival_s
    return np.asarray(float(np.median(late_s)) + interval_s * number, dtype=np.float64)


def _earliest(late_s: Floats) -> tuple[Floats, Floats]:
    """Return number and lateness of the earliest value in each part of a stream, shape (blocks,) each."""
    blocks = min(_BLOCKS, late_s.size // _IN_BLOCK)
    edges = np.linspace(0, late_s.size, blocks + 1).astype(int)
    earliest = np.array([a + int(np.argmin(late_s[a:b])) for a, b in pairwise(edges)])
    return earliest.astype(np.float64), late_s[earliest]


def _usual_slope(at: Floats, late_s: Floats) -> float:
    """Return the median of the slopes between any two points (Theil and Sen): parts that come late tilt no line."""
    one, other = np.triu_indices(at.size, 1)
    return float(np.median((late_s[other] - late_s[one]) / (at[other] - at[one])))
