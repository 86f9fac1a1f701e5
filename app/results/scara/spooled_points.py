"""A points file kept as numbers in a temporary file, for as many passes as a solver needs.

A pass then costs a fraction of what reading text does, and memory holds one block.
"""

import os
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np

from catseye.app.files.columns import table_blocks
from catseye.app.results.scara.points import POINTS
from catseye.app.results.scara.table_budget import SeenTable
from catseye.calibration.core.types import Floats, Ints
from catseye.calibration.scara.points import Commands, Points, two_mounts
from catseye.procedures.kit.columns import Columns

_BLOCK_ROWS = 50_000

RECORD = np.dtype(
    [
        ("theta1_rad", "<f8"),
        ("theta2_rad", "<f8"),
        ("displacement_mm", "<f8"),
        ("sigma_mm", "<f8"),
        ("dead_path", "<i4"),
        ("reflector", "<i2"),
        ("direction1", "i1"),
        ("direction2", "i1"),
    ]
)
"""One distance in the temporary file."""


@dataclass(frozen=True)
class SpooledPoints:
    """Distances in a temporary file: a source of blocks for the solver.

    Attributes:
        file: of records, without a header; it has no name, so that it is gone however the program ends.
        reflector_names: names of the reflectors.
        dead_paths: (reflector name, segment) of each dead path.
        with_sigma: the uncertainties that the points state count.
        rows: number of distances.
        seen: what the points file shows of its uncertainties.
        mounts_rad: how the interferometer was turned on its flange in each segment, shape (dead paths,); None for a
            file that does not state it.
    """

    file: IO[bytes]
    reflector_names: tuple[str, ...]
    dead_paths: tuple[tuple[str, int], ...]
    with_sigma: bool
    rows: int
    seen: SeenTable
    mounts_rad: Floats | None = None

    def __len__(self) -> int:
        """Return the number of distances."""
        return self.rows

    def blocks(self) -> Iterator[Points]:
        """Return all distances in measuring order, anew at each call."""
        block_bytes = _BLOCK_ROWS * RECORD.itemsize
        for start in range(0, self.rows * RECORD.itemsize, block_bytes):
            records = np.frombuffer(os.pread(self.file.fileno(), block_bytes, start), RECORD)
            numbers = {name: records[name].astype(np.float64) for name in RECORD.names or ()}
            dead_path = records["dead_path"].astype(np.int64)
            yield Points(
                commands=Commands(
                    numbers["theta1_rad"],
                    numbers["theta2_rad"],
                    records["direction1"].astype(np.int64),
                    records["direction2"].astype(np.int64),
                ),
                reflector=records["reflector"].astype(np.int64),
                dead_path=dead_path,
                displacement_mm=numbers["displacement_mm"],
                sigma_mm=numbers["sigma_mm"] if self.with_sigma else None,
                reflector_names=self.reflector_names,
                dead_paths=self.dead_paths,
                mount_rad=None if self.mounts_rad is None else self.mounts_rad[dead_path],
            )


@contextmanager
def spooled_points(
    path: Path, known: Sequence[str], progress: Callable[[float], None] | None = None
) -> Iterator[SpooledPoints]:
    """Read a points file into a temporary file that lasts as long as the context.

    Args:
        path: the file; .parquet is Parquet, anything else CSV.
        known: names of the reflectors of the cell file, each once.
        progress: is called with the share of the file that is read.

    Raises:
        UsageError: the file is missing, a column is missing, a value is wrong; names file and line.
    """
    # Reflectors that the file does not name keep their place: without a dead path they are left out later.
    paths, seen, rows = _DeadPaths(tuple(known)), SeenTable(path), 0
    with tempfile.TemporaryFile() as file:
        for share, columns in table_blocks(path, POINTS, known):
            _records(columns, paths.index(columns)).tofile(file)
            seen.see(columns)
            rows += len(columns)
            if progress is not None:
                progress(share)
        names = tuple(known), paths.names
        yield SpooledPoints(file, *names, seen.with_sigma, rows, seen, paths.mounts_rad)


class _DeadPaths:
    """Numbers the segments in the order in which they first appear."""

    def __init__(self, known: tuple[str, ...]) -> None:
        self._known = known
        self._numbers: dict[tuple[int, int], int] = {}
        self._mounts_deg: list[float] = []
        self._mounted = False

    @property
    def names(self) -> tuple[tuple[str, int], ...]:
        """(Reflector name, segment) of each."""
        return tuple((self._known[reflector], segment) for reflector, segment in self._numbers)

    @property
    def mounts_rad(self) -> Floats | None:
        """How the interferometer was turned in each, shape (k,); None where the file does not state it."""
        return np.deg2rad(self._mounts_deg) if self._mounted else None

    def index(self, columns: Columns) -> Ints:
        """Return the dead path of each row, shape (n,).

        Raises:
            ArgumentError: the interferometer is turned on its flange within a segment.
        """
        reflector, segment = columns["reflector"].astype(np.int64), columns["segment"].astype(np.int64)
        self._mounted |= "mount_deg" in columns
        mount = columns["mount_deg"] if self._mounted else np.zeros(len(columns))
        changes = (np.diff(segment) != 0) | (np.diff(reflector) != 0) | (np.diff(mount) != 0.0)
        starts = np.concatenate([[0], np.flatnonzero(changes) + 1]) if len(columns) else np.zeros(0, np.int64)
        keys = zip(reflector[starts].tolist(), segment[starts].tolist(), strict=True)
        numbers = [self._number(key, mount_deg) for key, mount_deg in zip(keys, mount[starts], strict=True)]
        return np.repeat(np.array(numbers, dtype=np.int64), np.diff(np.append(starts, len(columns))))

    def _number(self, key: tuple[int, int], mount_deg: float) -> int:
        number = self._numbers.setdefault(key, len(self._numbers))
        if number == len(self._mounts_deg):
            self._mounts_deg.append(mount_deg)
        elif self._mounts_deg[number] != mount_deg:
            raise two_mounts(self.names[number])
        return number


def _records(columns: Columns, dead_path: Ints) -> np.ndarray[tuple[int, ...], np.dtype[np.void]]:
    records = np.zeros(len(columns), dtype=RECORD)
    records["theta1_rad"] = np.deg2rad(columns["theta1_deg"])
    records["theta2_rad"] = np.deg2rad(columns["theta2_deg"])
    records["dead_path"] = dead_path
    for name in set(columns.values) & set(RECORD.names or ()):
        records[name] = columns[name]
    return records
