"""What was driven while an instrument measured: a path file, or the corrected commands of catseye compensate."""

from pathlib import Path

from catseye.app.files.columns import read_table
from catseye.app.files.csv_lines import cells_of, is_comment
from catseye.app.files.drawings import SUFFIX
from catseye.app.files.foreign_csv import first_lines
from catseye.app.results.scara.path_csv import (
    JOINTS,
    PLACE,
    CommandPath,
    Start,
    line_numbers,
    read_path_csv,
)
from catseye.app.results.scara.points import commands_of
from catseye.calibration.scara.planar import Hand
from catseye.procedures.scara.path.tables import JOINT_ROWS

_TOP = 100
"""Lines among which the header is."""


def driven_path(file: Path, nominal: tuple[float, float], hand: Hand, start: Start) -> CommandPath:
    """Read what was driven; arguments and errors are those of `read_path_csv`."""
    if not _is_corrected(file):
        return read_path_csv(file, nominal, hand, start)
    columns = read_table(file, JOINT_ROWS)
    return CommandPath(
        commands_of(columns),
        columns.stacked(PLACE),
        cartesian=False,
        numbers=line_numbers(file, columns),
    )


def _is_corrected(file: Path) -> bool:
    """Return whether a file holds wished places beside their joint commands."""
    if file.suffix == SUFFIX:
        return False
    lines = enumerate(first_lines(file, "utf-8-sig", _TOP), 1)
    header = next((cells_of(file, number, line) for number, line in lines if not is_comment(line)), [])
    return {PLACE[0], JOINTS[0]} <= set(header)
