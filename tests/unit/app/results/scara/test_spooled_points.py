"""Points files in blocks: the same distances as the reader of whole files, the same complaints with their line."""

import csv
import importlib
import io
import os
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from catseye.app.errors import ConfigError, UsageError
from catseye.app.files import csv_lines
from catseye.app.results.scara.points import COLUMNS, read_points, to_points
from catseye.app.results.scara.spooled_points import spooled_points
from catseye.calibration.core.errors import ArgumentError
from catseye.calibration.scara.points import Points, concatenated

KNOWN = ["P1", "P2", "P3", "P0"]
ROWS = 5_000


def table(rows: int = ROWS, *, sigma: bool = True) -> dict[str, list[object]]:
    rng = np.random.default_rng(4)
    columns: dict[str, list[object]] = {
        "reflector": [KNOWN[i * 3 // rows] for i in range(rows)],
        "segment": [i * 6 // rows % 2 for i in range(rows)],
        "theta1_deg": rng.uniform(-140.0, 60.0, rows).tolist(),
        "theta2_deg": rng.uniform(0.0, 140.0, rows).tolist(),
        "direction1": rng.choice([-1, 1], rows).tolist(),
        "direction2": rng.choice([-1, 1], rows).tolist(),
        "displacement_mm": rng.uniform(-500.0, 500.0, rows).tolist(),
    }
    if sigma:
        columns["sigma_mm"] = rng.uniform(0.001, 0.02, rows).tolist()
    return columns


def written(path: Path, columns: dict[str, list[object]]) -> Path:
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(columns)
    writer.writerows(zip(*columns.values(), strict=True))
    path.write_text(out.getvalue(), encoding="utf-8")
    return path


def read(path: Path, progress: Callable[[float], None] | None = None) -> Points:
    with spooled_points(path, KNOWN, progress) as spooled:
        blocks = list(spooled.blocks())
        assert sum(len(block) for block in blocks) == len(spooled)
        again = concatenated(list(spooled.blocks()))
    whole = concatenated(blocks)
    assert np.array_equal(whole.displacement_mm, again.displacement_mm)
    assert spooled.file.closed
    return whole


def require_same(found: Points, path: Path) -> None:
    expected = to_points(read_points(path, KNOWN), KNOWN)
    assert [found.reflector_names[i] for i in found.reflector] == [
        expected.reflector_names[i] for i in expected.reflector
    ]
    assert found.dead_paths == expected.dead_paths
    assert np.array_equal(found.dead_path, expected.dead_path)
    for name in ("theta1_rad", "theta2_rad", "direction1", "direction2"):
        assert np.array_equal(getattr(found.commands, name), getattr(expected.commands, name))
    assert np.array_equal(found.displacement_mm, expected.displacement_mm)
    if expected.sigma_mm is None:
        assert found.sigma_mm is None
    else:
        assert found.sigma_mm is not None
        assert np.array_equal(found.sigma_mm, expected.sigma_mm)
    if expected.mount_rad is None:
        assert found.mount_rad is None
    else:
        assert found.mount_rad is not None
        assert np.array_equal(found.mount_rad, expected.mount_rad)


@pytest.mark.parametrize("sigma", [True, False])
def test_the_same_distances_as_row_by_row(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, sigma: bool
) -> None:
    monkeypatch.setattr(csv_lines, "_CHUNK_BYTES", 10_000)
    shares: list[float] = []
    path = written(tmp_path / "points.csv", table(sigma=sigma))
    require_same(read(path, shares.append), path)
    assert shares == sorted(shares)
    assert shares[-1] == pytest.approx(1.0)


@pytest.mark.parametrize("parquet", [True, False])
def test_mountings_are_those_of_the_segments(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, parquet: bool
) -> None:
    monkeypatch.setattr(csv_lines, "_CHUNK_BYTES", 10_000)
    columns = table()
    columns["mount_deg"] = [180.25 * int(str(segment)) for segment in columns["segment"]]
    path = written(tmp_path / "points.csv", columns)
    assert read_points(path, KNOWN)["mount_deg"].tolist() == columns["mount_deg"]
    require_same(read(parquet_file(tmp_path / "points.parquet", columns) if parquet else path), path)


@pytest.mark.parametrize("line", [3, 1_800, 4_999])
def test_a_segment_has_one_mounting(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, line: int) -> None:
    monkeypatch.setattr(csv_lines, "_CHUNK_BYTES", 10_000)
    columns = table()
    columns["mount_deg"] = [0.0] * ROWS
    columns["mount_deg"][line] = 180.0
    path = written(tmp_path / "points.csv", columns)
    named = f"segment {columns['segment'][line]} of reflector {columns['reflector'][line]} has more than one mount"
    with pytest.raises(ArgumentError, match=named):
        read(path)
    with pytest.raises(ArgumentError, match=named):
        to_points(read_points(path, KNOWN), KNOWN)


def test_comments_blanks_quotes_and_line_ends_are_read_as_elsewhere(tmp_path: Path) -> None:
    path = tmp_path / "points.csv"
    text = written(path, table(50)).read_text()
    lines = text.splitlines()
    lines[0:0] = ["# made by hand", "", "  # and again"]
    lines[20:20] = ["", "# in between"]
    lines[30] = lines[30].replace("P", '"P', 1).replace(",", '",', 1)
    lines[31] = lines[31].replace(",", " , ")
    path.write_bytes(b"\xef\xbb\xbf" + "\r\n".join(lines).encode())
    require_same(read(path), path)


@pytest.mark.parametrize("line", [2, 1800, 4999])
@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("reflector", "P9"),
        ("segment", "1.5"),
        ("segment", "1152921504606846976"),
        ("segment", "99999999999999999999"),
        ("theta1_deg", "nan"),
        ("theta2_deg", "12,5"),
        ("direction1", "0"),
        ("direction2", ""),
        ("displacement_mm", "1e400"),
        ("displacement_mm", "12#3"),
        ("sigma_mm", "0"),
    ],
)
def test_a_wrong_value_is_reported_as_elsewhere(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, column: str, value: str, line: int
) -> None:
    monkeypatch.setattr(csv_lines, "_CHUNK_BYTES", 20_000)
    columns = table()
    columns[column][line - 2] = value
    path = written(tmp_path / "points.csv", columns)
    path.write_text(path.read_text().replace('"', ""))
    with pytest.raises(UsageError) as expected:
        read_points(path, KNOWN)
    with pytest.raises(UsageError) as found:
        read(path)
    assert str(found.value) == str(expected.value)
    assert f"points.csv:{line}:" in str(found.value)


@pytest.mark.parametrize(
    "content",
    [b"", b"# only talk\n", b"reflector,segment\nP1,0\n", ",".join(COLUMNS).encode() + b"\n", b"\xff\xfe\n"],
)
def test_a_file_without_distances_is_reported_as_elsewhere(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "points.csv"
    path.write_bytes(content)
    with pytest.raises(UsageError) as expected:
        read_points(path, KNOWN)
    with pytest.raises(UsageError) as found:
        read(path)
    assert str(found.value) == str(expected.value)


def test_a_missing_file_is_reported(tmp_path: Path) -> None:
    for name in ("points.csv", "points.parquet"):
        with pytest.raises(UsageError, match="no such file"):
            read(tmp_path / name)


def parquet_file(path: Path, columns: dict[str, list[object]]) -> Path:
    arrow, parquet = (importlib.import_module(name) for name in ("pyarrow", "pyarrow.parquet"))
    parquet.write_table(arrow.table(columns), path)
    return path


def test_parquet_holds_the_same_distances(tmp_path: Path) -> None:
    columns = table()
    path = parquet_file(tmp_path / "points.parquet", columns | {"event": list(range(ROWS))})
    require_same(read(path), written(tmp_path / "points.csv", columns))


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("reflector", "P9"),
        ("reflector", None),
        ("segment", 1.5),
        ("segment", None),
        ("direction1", 0),
        ("theta1_deg", None),
        ("sigma_mm", -1.0),
    ],
)
def test_a_wrong_value_of_parquet_is_reported_with_its_row(
    tmp_path: Path, column: str, value: object
) -> None:
    columns = table()
    if isinstance(value, float):
        columns[column] = [float(str(one)) for one in columns[column]]
    columns[column][99] = value
    with pytest.raises(UsageError, match=rf"points.parquet: row 100: {column} = {value!r}"):
        read(parquet_file(tmp_path / "points.parquet", columns))


@pytest.mark.parametrize(
    ("column", "values", "text"),
    [
        ("reflector", [None] * ROWS, "row 1: reflector = None cannot be"),
        ("reflector", [["P1"]] * ROWS, "cannot be read as Parquet"),
        ("theta1_deg", [{"deg": 1.0}] * ROWS, "cannot be read as Parquet"),
    ],
)
def test_parquet_with_a_column_of_another_kind_is_refused(
    tmp_path: Path, column: str, values: list[object], text: str
) -> None:
    columns = table() | {column: values}
    with pytest.raises(UsageError, match=rf"points.parquet: {text}"):
        read(parquet_file(tmp_path / "points.parquet", columns))


def test_parquet_from_a_pipe_is_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "points.parquet")
    with pytest.raises(UsageError, match="is a pipe, not a regular file"):
        read(tmp_path / "points.parquet")


def test_parquet_without_a_column_or_that_is_none(tmp_path: Path) -> None:
    columns = table(10)
    del columns["direction2"]
    with pytest.raises(UsageError, match="column direction2 is missing"):
        read(parquet_file(tmp_path / "points.parquet", columns))
    (tmp_path / "text.parquet").write_text("reflector,segment\n")
    with pytest.raises(UsageError, match="cannot be read as Parquet"):
        read(tmp_path / "text.parquet")


def test_parquet_without_its_package_names_the_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> object:
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(ConfigError, match=r"pip install 'catseye\[parquet\]'"):
        read(tmp_path / "points.parquet")
