"""CSV files of other programs."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from catseye.app.errors import UsageError
from catseye.app.files.foreign_csv import found_dialect, read_numbers
from catseye.drivers.roles.text_table import Dialect

_POINTS = Dialect(",", ".", 1, "utf-8")


def _file(tmp_path: Path, text: str | bytes) -> Path:
    path = tmp_path / "laser.csv"
    path.write_bytes(text if isinstance(text, bytes) else text.encode())
    return path


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("t,x\n0.1,2.5\n0.2,2.6\n0.3,2.7\n", Dialect(",", ".", 1, "utf-8")),
        ("Laser\n\nt;x\n0,1;2,5\n0,2;2,6\n0,3;2,7\n", Dialect(";", ",", 3, "utf-8")),
        ("0.1\t2.5\n0.2\t2.6\n0.3\t2.7\n", Dialect("tab", ".", 0, "utf-8")),
        ("t x\n 0,1  2,5\n 0,2  2,6\n 0,3  2,7\n", Dialect("blank", ",", 1, "utf-8")),
        ("t;µm\n0,1;2,5\n0,2;2,6\n0,3;2,7\n".encode("cp1252"), Dialect(";", ",", 1, "cp1252")),
    ],
)
def test_the_way_a_file_is_written_is_found(tmp_path: Path, text: str | bytes, expected: Dialect) -> None:
    assert found_dialect(_file(tmp_path, text)) == expected


def test_names_may_stand_beside_the_numbers(tmp_path: Path) -> None:
    path = _file(tmp_path, "Name;X;Y\nP1;1,5;2,5\nP2;1,6;2,6\nP3;1,7;2,7\n")
    assert found_dialect(path, named=True) == Dialect(";", ",", 1, "utf-8")
    with pytest.raises(UsageError, match="no table of numbers begins"):
        found_dialect(path)


def test_numbered_names_leave_a_table_separated_by_tabs(tmp_path: Path) -> None:
    path = _file(tmp_path, "name\tX [µm]\tY [µm]\nPoint 1\t1.0\t2.0\nPoint 2\t1.1\t2.0\nPoint 3\t1.2\t2.0\n")
    assert found_dialect(path, named=True) == Dialect("tab", ".", 1, "utf-8")


def test_a_file_without_numbers_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no table of numbers begins in its first 200 lines"):
        found_dialect(_file(tmp_path, "a,b\nc,d\n"))


def test_columns_are_read_with_their_lines(tmp_path: Path) -> None:
    path = _file(tmp_path, "Laser\nt;x;y\n1,5;7;-2,5\n# paused\n\n2,5;8;1e-3\n")
    columns, lines = read_numbers(path, Dialect(";", ",", 2, "utf-8"), (2, 0))
    assert [column.tolist() for column in columns] == [[-2.5, 0.001], [1.5, 2.5]]
    assert lines.tolist() == [3, 6]


@pytest.mark.parametrize(
    ("row", "complaint"),
    [
        ("0.2", "laser.csv:3: 1 columns, but column 2 is wanted: the file is cut off there"),
        ("0.2,oops", "laser.csv:3: column 2 holds 'oops', no number with a decimal point"),
        ("0.2,1_000", "laser.csv:3: column 2 holds '1_000', no number with a decimal point"),
        ("0.2,nan", "laser.csv:3: column 2 holds 'nan', no number"),
    ],
)
def test_the_first_bad_line_is_named(tmp_path: Path, row: str, complaint: str) -> None:
    with pytest.raises(UsageError, match=complaint):
        read_numbers(_file(tmp_path, f"t,x\n0.1,2.5\n{row}\nworse\n"), _POINTS, (0, 1))


def test_points_are_no_decimal_commas(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"2: column 1 holds '1\.500,0'"):
        read_numbers(_file(tmp_path, "t;x\n1.500,0;1\n"), Dialect(";", ",", 1, "utf-8"), (0,))


def test_a_file_of_headings_alone_has_no_rows(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match="no row stands below its 1 header lines"):
        read_numbers(_file(tmp_path, "t,x\n"), _POINTS, (0, 1))


@given(
    st.lists(st.tuples(st.floats(-1e9, 1e9), st.floats(-1e-9, 1e9)), min_size=1, max_size=20),
    st.sampled_from([(";", ","), (";", "."), ("tab", ","), ("blank", "."), (",", ".")]),
)
def test_numbers_are_read_as_they_were_written(
    tmp_path_factory: pytest.TempPathFactory, rows: list[tuple[float, float]], written: tuple[str, str]
) -> None:
    separator, decimal = written
    sign = {"tab": "\t", "blank": "  "}.get(separator, separator)
    text = "\n".join(sign.join(repr(value).replace(".", decimal) for value in row) for row in rows)
    path = tmp_path_factory.mktemp("csv") / "laser.csv"
    path.write_text(f"heading\n{text}\n", "utf-8")
    dialect = Dialect(separator, decimal, 1, "utf-8")  # type: ignore[arg-type]  # pairs of the list above
    columns, _ = read_numbers(path, dialect, (0, 1))
    np.testing.assert_array_equal(np.column_stack(columns), rows)
