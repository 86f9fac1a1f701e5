"""Files of a test that another program recorded: recording and moves, for the evaluation in rad or mm."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

import numpy as np
from numpy.typing import NDArray

from catseye.app.errors import UsageError
from catseye.app.files.columns import read_table
from catseye.app.results.resolution.last_line import is_whole, require_whole
from catseye.app.results.resolution.recording_mapping import RecordingMapping, read_mapped_recording
from catseye.app.results.resolution.tables import MOVES, RECORDING
from catseye.calibration.core.types import Bools
from catseye.calibration.resolution.errors import MovesError, RecordingError
from catseye.calibration.resolution.flags import Flag
from catseye.calibration.resolution.moves import Moves, moves_of
from catseye.calibration.resolution.optics import AngleAccuracy, AngularOptics
from catseye.calibration.resolution.recording import Recording, recording_of
from catseye.calibration.resolution.sampling import require_stated_rate, require_steady_rate
from catseye.procedures.kit.columns import Columns

_ANGLES_STAY: Final = (
    "the recording holds angles: --spacing-mm does not change them and only states that they are as accurate as "
    "those of angular optics; give displacement_mm to compute them again"
)

_NO_RECORDING: Final = {
    ".rtx": (
        "is in a format that only the laser's own software reads: export the samples from the program that recorded "
        "them as text or CSV, a row each with its time, and give that file with --preview to see how it is read"
    ),
    ".rtl": "holds deviations at targets and no times: it is not a recording; --test backlash accepts it",
    ".rta": "holds deviations at targets and no times: it is not a recording; --test backlash accepts it",
    ".dat": (
        "is a trace of the controller, whose encoders do not see what the joint does: a recording comes from a "
        "laser; as --joint-torque the trace is welcome"
    ),
}


@dataclass(frozen=True)
class RecordingFile:
    """Where a recording comes from and how to read it.

    Attributes:
        path: CSV, or Parquet with the same columns.
        mapping: of a file that another program wrote; None for one with the names of this program.
        optics: that turn displacements into angles; None where displacements are what is judged.
        rate_hz: that somebody states beside the file, held against its times; None where nobody does.
        accuracy: of an instrument whose recording holds angles; None where nobody states it.
        zero_is_stated: somebody knows at which angle the optics stand where the displacement is 0.
    """

    path: Path
    mapping: RecordingMapping | None = None
    optics: AngularOptics | None = None
    rate_hz: float | None = None
    accuracy: AngleAccuracy | None = None
    zero_is_stated: bool = False

    @property
    def stated_rate_hz(self) -> float | None:
        """Rate stated beside the file or in its mapping; None where nobody states one."""
        return self.rate_hz if self.rate_hz or self.mapping is None else self.mapping.rate_hz


@dataclass(frozen=True)
class MovesFile:
    """Moves and where they stand.

    Attributes:
        path: of the file.
        moves: that count.
        lines: of each of them, shape (n,).
        all_moves: those as well that only lead to the beginning of the test.
    """

    path: Path
    moves: Moves
    lines: NDArray[np.int64]
    all_moves: Moves

    def place(self, number: int | None) -> str:
        """Return file and line of a move by its number from 1, the file alone without one."""
        return f"{self.path}" if number is None else f"{self.path}:{self.lines[number - 1]}"


def require_recording(path: Path) -> None:
    """Refuse a file that, by the end of its name, is no recording.

    Raises:
        UsageError: says what it is and what to do.
    """
    if refusal := _NO_RECORDING.get(path.suffix.lower()):
        raise UsageError(f"{path}: {refusal}")


def recording_columns(file: RecordingFile) -> Columns:
    """Read the columns of a recording, t_s and displacement_mm or angle_deg; a last line without end does not count.

    Raises:
        UsageError: the file cannot be used; names line and remedy.
    """
    require_recording(file.path)
    mapping = file.mapping
    columns = (
        read_table(file.path, RECORDING) if mapping is None else read_mapped_recording(file.path, mapping)
    )
    return columns if is_whole(file.path) else columns.first(len(columns) - 1)


def read_recording(file: RecordingFile) -> Recording:
    """Read a recording, of a joint in rad, of a slide or of the tool in mm.

    Raises:
        UsageError: the file cannot be used, its rate changes or is not the one that is stated, or times or signal
            cannot be; names line and remedy.
    """
    columns = recording_columns(file)
    if file.accuracy is not None and "angle_deg" not in columns:
        raise UsageError(
            f"{file.path}: holds displacements, whose accuracy is that of their optics: leave out --accuracy-urad "
            "and --accuracy-percent, and state --spacing-mm of angular optics"
        )
    if file.zero_is_stated and "angle_deg" in columns:
        raise UsageError(
            f"{file.path}: holds angles, which another program has made of displacements with a zero of its own: "
            "leave out --zero-deg, or give the displacements"
        )
    try:
        recording = _recording_of(columns, file.optics)
        require_steady_rate(columns["t_s"])
        if file.stated_rate_hz is not None:
            require_stated_rate(columns["t_s"], file.stated_rate_hz)
    except RecordingError as error:
        raise _at_line(file, columns, error) from error
    if file.optics is not None and "angle_deg" in columns:
        return replace(recording, flags=(*recording.flags, Flag("scale", _ANGLES_STAY)))
    return recording


def refused_recording(file: RecordingFile, error: RecordingError) -> UsageError:
    """Return what is wrong with a recording that was read, with the line of its sample."""
    return _at_line(file, recording_columns(file), error)


def _at_line(file: RecordingFile, columns: Columns, error: RecordingError) -> UsageError:
    place = "" if error.row is None else f":{columns.lines[error.row - 1]}"
    return UsageError(f"{file.path}{place}: {error}")


def _recording_of(columns: Columns, optics: AngularOptics | None) -> Recording:
    time_s = columns["t_s"]
    if "angle_deg" in columns:
        return recording_of(time_s, np.radians(columns["angle_deg"]), "rad")
    displacement_mm = columns["displacement_mm"]
    if optics is None:
        return recording_of(time_s, displacement_mm, "mm")
    return recording_of(time_s, optics.angle_rad(displacement_mm), "rad")


def read_moves(path: Path, *, there_and_back: bool = False) -> MovesFile:
    """Read the moves of a test, of a joint in rad, of a slide or of the tool in mm.

    Args:
        path: of the file.
        there_and_back: moves whose `sequence` is 0 only lead to the beginning of such a test, and do not count.

    Raises:
        UsageError: the file cannot be used; names line and remedy.
    """
    columns = read_table(path, MOVES)
    require_whole(path)
    sequence, every = columns.get("sequence"), np.ones(len(columns), dtype=np.bool_)
    counted = every if sequence is None or not there_and_back else sequence > 0.0
    all_moves = _moves_of(path, columns, every)
    return MovesFile(path, _moves_of(path, columns, counted), columns.lines[counted], all_moves)


def _moves_of(path: Path, columns: Columns, wanted: Bools) -> Moves:
    time_s, angular = columns["t_s"][wanted], columns.get("command_deg")
    try:
        if angular is not None:
            return moves_of(time_s, np.radians(angular[wanted]), "rad")
        return moves_of(time_s, columns["command_mm"][wanted], "mm")
    except MovesError as error:
        place = "" if error.row is None else f":{columns.lines[wanted][error.row - 1]}"
        raise UsageError(f"{path}{place}: {error}") from error
