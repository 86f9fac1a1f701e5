"""Points CSV: full precision there and back, and what is said about a file that cannot be used."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from catseye.app.errors import UsageError
from catseye.app.files.column_rules import LARGEST_NUMBER
from catseye.app.results.scara.points import (
    COLUMNS,
    point_columns,
    points_csv,
    read_points,
    to_points,
    with_sigma,
)
from catseye.procedures.kit.columns import Columns

NAMES = ("P1", "P2", "a.b-c+d_e")
HEADER = ",".join(COLUMNS)
GOOD = "P1,0,-140.0,20.0,1,-1,-12.345678901234567"

finite = st.floats(-LARGEST_NUMBER, LARGEST_NUMBER)
signs = st.sampled_from([1, -1])


rows_of_a_file = st.lists(
    st.tuples(st.sampled_from(NAMES), st.integers(0, 999), finite, finite, signs, signs, finite),
    min_size=1,
    max_size=5,
)


def table(*rows: tuple[object, ...]) -> Columns:
    return point_columns([dict(zip(COLUMNS, row, strict=True)) for row in rows])


def rows_of(columns: Columns) -> list[tuple[object, ...]]:
    """Return the rows of a table by the names of its reflectors."""
    numbers = (
        columns[name].tolist()
        for name in (*COLUMNS[1:], *(name for name in ("sigma_mm", "mount_deg") if name in columns))
    )
    names = [columns.names[int(place)] for place in columns["reflector"]]
    return list(zip(names, *numbers, strict=True))


def written(folder: Path, data: str | bytes) -> Path:
    path = folder / "points.csv"
    path.write_bytes(data.encode("utf-8") if isinstance(data, str) else data)
    return path


@given(rows_of_a_file, st.none() | st.floats(1e-9, 1.0))
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
def test_what_is_written_is_read_to_the_last_bit(
    tmp_path: Path, rows: list[tuple[object, ...]], sigma_mm: float | None
) -> None:
    given = table(*rows) if sigma_mm is None else with_sigma(table(*rows), sigma_mm)
    assert rows_of(read_points(written(tmp_path, points_csv(given)), NAMES)) == rows_of(given)


@pytest.mark.parametrize(
    "text",
    [
        f"{HEADER}\n{GOOD}\n",
        f"\ufeff{HEADER}\r\n{GOOD}\r\n",
        f"# made by hand\n\n{HEADER}\n# first\n{GOOD}\n   # last\n\n",
        f"{HEADER}\n P1 , 0 , -140 ,2e1, +1 ,-1.0, -12.345678901234567",
        f'{HEADER}\n"P1",0,-140.0,20.0,1,-1,-12.345678901234567\n',
    ],
)
def test_ways_to_write_the_same_row(tmp_path: Path, text: str) -> None:
    expected = ("P1", 0, -140.0, 20.0, 1, -1, -12.345678901234567)
    assert rows_of(read_points(written(tmp_path, text), NAMES)) == [expected]


def test_columns_may_stand_in_any_order(tmp_path: Path) -> None:
    text = "sigma_mm,displacement_mm,direction2,direction1,theta2_deg,theta1_deg,segment,reflector\n"
    (row,) = rows_of(read_points(written(tmp_path, text + "0.01,5.5,-1,1,20,40,3,P2\n"), NAMES))
    assert row == ("P2", 3, 40.0, 20.0, 1, -1, 5.5, 0.01)


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", ["points.csv: is empty", HEADER]),
        ("# nothing\n\n", ["points.csv: is empty"]),
        (f"{HEADER}\n", ["points.csv: holds no points"]),
        (f"#\n{HEADER.replace(',segment', '')}\n", ["points.csv:2: column segment is missing", "comma"]),
        (f"{HEADER},segment\n", ["points.csv:1: column segment stands twice"]),
        (f"{HEADER},note\n", ["points.csv:1: unknown column note", "allowed are"]),
        (f"{HEADER}\n{GOOD}\n{GOOD},7\n", ["points.csv:3: 8 values, but the header has 7 columns"]),
        (f"{HEADER}\n{GOOD}\n#\nP1,0,1\n", ["points.csv:4: 3 values"]),
        (f'{HEADER}\n"{GOOD}\n', ["points.csv:2: 1 values"]),
        (f"{HEADER}\nP9{GOOD[2:]}\n", ["points.csv:2: unknown reflector 'P9'", "P1, P2, a.b-c+d_e"]),
        (f"{HEADER}\nP1,0.5,1,2,1,1,3\n", ["points.csv:2: segment = '0.5' is not an integer"]),
        (f"{HEADER}\nP1,0,nan,2,1,1,3\n", ["points.csv:2: theta1_deg = 'nan' is not a finite number"]),
        (f"{HEADER}\nP1,0,1,-inf,1,1,3\n", ["points.csv:2: theta2_deg = '-inf'"]),
        (f"{HEADER}\nP1,0,1,2,0,1,3\n", ["points.csv:2: direction1 = '0' is not 1 or -1"]),
        (f"{HEADER}\nP1,0,1,2,1,up,3\n", ["points.csv:2: direction2 = 'up' is not 1 or -1"]),
        (f"{HEADER}\nP1,0,1,2,1,1,1,5\n", ["points.csv:2: 8 values"]),
        (f"{HEADER}\nP1,0,1,2,1,1,\n", ["points.csv:2: displacement_mm = '' is not a finite number"]),
        (
            f"{HEADER}\n{GOOD}\n".replace(",", ";").replace(".", ","),
            ["points.csv:1: ", "separated by semicolons"],
        ),
        (f"{HEADER}\n{GOOD}\n".replace(",", "\t"), ["separated by tabs: export the file with commas"]),
        (f"{HEADER},sigma_mm\n{GOOD},0\n", ["points.csv:2: sigma_mm = '0' is not a finite number above 0"]),
        (f"{HEADER},sigma_mm\n{GOOD},-1\n", ["points.csv:2: sigma_mm = '-1'"]),
        (f"{HEADER},sigma_mm\n{GOOD},15.8\n", ["points.csv:2: sigma_mm = 15.8 is more than 1 mm", "in µm"]),
        (f"{HEADER}\n{GOOD}{'0' * 140_000}\n", ["points.csv:2: ", "too long"]),
    ],
)
def test_a_fault_is_reported_with_file_and_line(tmp_path: Path, text: str, expected: list[str]) -> None:
    with pytest.raises(UsageError) as caught:
        read_points(written(tmp_path, text), NAMES)
    for part in expected:
        assert part in str(caught.value)


def test_other_encodings_and_missing_files_are_reported(tmp_path: Path) -> None:
    with pytest.raises(UsageError, match=r"points\.csv:2: is not UTF-8 text"):
        read_points(written(tmp_path, f"{HEADER}\n# µ\n".encode("latin-1")), NAMES)
    with pytest.raises(UsageError, match=r"none\.csv: there is no such file"):
        read_points(tmp_path / "none.csv", NAMES)
    with pytest.raises(UsageError, match="cannot be read: Is a directory"):
        read_points(tmp_path, NAMES)


def test_rows_become_columns_in_the_order_of_the_cell_file() -> None:
    rows = table(
        ("P3", 1, 90.0, -180.0, 1, -1, 7.0),
        ("P1", 0, 0.0, 45.0, -1, 1, 8.0),
        ("P3", 0, 0.0, 45.0, -1, 1, 9.0),
    )
    rows = replace(rows, values={**rows.values, "sigma_mm": np.array([0.01, 0.02, 0.03])})
    points = to_points(rows, ["P1", "P2", "P3"])
    assert points.reflector_names == ("P1", "P3")
    assert points.reflector.tolist() == [1, 0, 1]
    assert points.dead_paths == (("P3", 1), ("P1", 0), ("P3", 0))
    assert points.dead_path.tolist() == [0, 1, 2]
    assert points.commands.theta1_rad == pytest.approx([math.pi / 2, 0.0, 0.0])
    assert points.commands.theta2_rad == pytest.approx([-math.pi, math.pi / 4, math.pi / 4])
    assert points.commands.direction1.tolist() == [1, -1, -1]
    assert points.commands.direction2.tolist() == [-1, 1, 1]
    assert points.sigma_mm is not None
    assert np.array_equal(points.sigma_mm, [0.01, 0.02, 0.03])


def test_mountings_stand_in_a_column_where_any_was_turned(tmp_path: Path) -> None:
    first = dict(zip(COLUMNS, ("P1", 0, 90.0, 20.0, 1, -1, 7.0), strict=True))
    second = {**first, "segment": 1, "mount_deg": 179.5}
    assert "mount_deg" not in point_columns([first, {**first, "mount_deg": 0.0}])
    assert to_points(point_columns([first]), ["P1"]).mount_rad is None
    turned = point_columns([{**first, "mount_deg": None}, second])
    again = read_points(written(tmp_path, points_csv(turned)), NAMES)
    assert rows_of(again) == rows_of(turned)
    points = to_points(again, ["P1"])
    assert points.mount_rad is not None
    assert points.mount_rad.tolist() == [0.0, np.deg2rad(179.5)]
