"""Tables are read line by line, from pipes too, and what no table holds is named with its line."""

import os
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from catseye.app.errors import UsageError
from catseye.app.files.columns import read_table, read_typed_table, table_blocks
from catseye.app.files.csv_lines import LONGEST_LINE
from catseye.app.protocol.procedures import load_procedure, parse_params
from catseye.app.results.scara.path_csv import read_path_csv
from catseye.app.results.scara.points import COLUMNS, POINTS, read_points
from catseye.app.results.scara.scan import is_scan
from catseye.procedures.scara.path.tables import JOINT_ROWS, MEASURED

HEADER = ",".join(COLUMNS)
ROW = "P1,0,-40.0,20.0,1,-1,0.25"


def points(path: Path) -> int:
    return len(read_points(path, ["P1"]))


def blocks(path: Path) -> int:
    return sum(len(columns) for _, columns in table_blocks(path, POINTS, ["P1"]))


def commands(path: Path) -> int:
    return len(read_path_csv(path, (325.0, 225.0)).rows)


def measured(path: Path) -> int:
    return len(read_table(path, MEASURED))


def joint_rows(path: Path) -> int:
    return len(read_table(path, JOINT_ROWS))


TABLES: dict[Callable[[Path], int], tuple[str, str]] = {
    points: (HEADER, ROW),
    blocks: (HEADER, ROW),
    commands: ("x_mm,y_mm", "400,100"),
    measured: ("x_mm,y_mm,x_meas_mm,y_meas_mm", "400,100,400.1,100.1"),
    joint_rows: ("x_mm,y_mm,theta1_deg,theta2_deg,direction1,direction2", "1,2,3,4,1,-1"),
}
EACH_TABLE = pytest.mark.parametrize("read", TABLES, ids=lambda read: read.__name__)


@contextmanager
def pipe_of(raw: bytes) -> Iterator[Path]:
    """Provide a pipe as a shell's process substitution does."""
    reading, writing = os.pipe()

    def write() -> None:
        with os.fdopen(writing, "wb") as stream:
            stream.write(raw)

    writer = threading.Thread(target=write)
    writer.start()
    try:
        yield Path(f"/dev/fd/{reading}")
    finally:
        os.close(reading)
        writer.join()


@EACH_TABLE
def test_a_table_may_come_through_a_pipe(read: Callable[[Path], int]) -> None:
    header, row = TABLES[read]
    with pipe_of("\n".join([header, *[row] * 3000, ""]).encode()) as path:
        assert read(path) == 3000


def test_a_pipe_is_left_unread_by_the_look_for_scans() -> None:
    with pipe_of(f"{HEADER}\n{ROW}\n".encode()) as path:
        assert not is_scan(path)
        assert points(path) == 1


@EACH_TABLE
@pytest.mark.parametrize(
    ("bad", "said"),
    [
        (b"a\0b", "NUL bytes"),
        (b"M\xfcnchen", "not UTF-8"),
        (b"# M\xfcnchen", "not UTF-8"),
        (b"9" * (LONGEST_LINE + 1), "too long"),
    ],
)
def test_what_no_table_holds_is_named_with_its_line(
    tmp_path: Path, read: Callable[[Path], int], bad: bytes, said: str
) -> None:
    header, row = TABLES[read]
    path = tmp_path / "table.csv"
    path.write_bytes(b"\n".join([b"# by hand", header.encode(), row.encode(), bad, row.encode(), b""]))
    with pytest.raises(UsageError, match=rf"table\.csv:4: .*{said}"):
        read(path)


def test_a_pipe_that_is_typed_at_a_run_is_refused(tmp_path: Path) -> None:
    pipe = tmp_path / "pipe.csv"
    os.mkfifo(pipe)
    with pytest.raises(UsageError, match="is a pipe"):
        read_typed_table(str(pipe), MEASURED)
    with pytest.raises(UsageError, match="is a pipe"):
        parse_params(load_procedure("validation-path").params_type, [f"joints={pipe}"])


@EACH_TABLE
def test_an_endless_table_of_zeros_is_refused(read: Callable[[Path], int]) -> None:
    with pytest.raises(UsageError, match="/dev/zero:1: "):
        read(Path("/dev/zero"))


@EACH_TABLE
@pytest.mark.parametrize("end", ["\r\n", "\n", ""])
def test_each_end_of_a_line_is_one(tmp_path: Path, read: Callable[[Path], int], end: str) -> None:
    header, row = TABLES[read]
    path = tmp_path / "table.csv"
    path.write_bytes((("\r\n" if end == "\r\n" else "\n").join([header, row, row]) + end).encode("utf-8-sig"))
    assert read(path) == 2


@EACH_TABLE
def test_a_number_of_5000_digits_is_named(tmp_path: Path, read: Callable[[Path], int]) -> None:
    header, row = TABLES[read]
    path = tmp_path / "table.csv"
    for column in range(row.count(",") + 1):
        cells = row.split(",")
        cells[column] = "9" * 5000
        path.write_text(f"{header}\n{','.join(cells)}\n")
        with pytest.raises(UsageError, match=r"table\.csv:"):
            read(path)


def test_lines_may_end_with_carriage_returns_alone(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    path.write_bytes(f"{HEADER}\r{ROW}\r{ROW}\r".encode())
    assert points(path) == blocks(path) == 2
