"""Tables as columns: the rules of a declaration, whatever the file and its length."""

import importlib
from pathlib import Path

import numpy as np
import pytest

from catseye.app.errors import UsageError
from catseye.app.files import csv_lines
from catseye.app.files.columns import read_rows, read_table, table_blocks
from catseye.procedures.kit.columns import ColumnRule, Columns, TableRule

SHARED = ColumnRule("note_mm", unit="mm", optional=True, positive=True, largest=5.0, hint="convert it")
TABLE = TableRule(
    "things",
    "one thing",
    (
        (ColumnRule("who", "name", known_to="the list"), ColumnRule("count", "integer"), SHARED),
        (
            ColumnRule("way", "direction", needed="a way has two ends"),
            ColumnRule("x_mm", empty="is open"),
            SHARED,
        ),
    ),
    mixed="both kinds stand in one file",
    misplaced=(("volume", "the file holds volumes"),),
)
OPEN = TableRule("rows", "one", ((ColumnRule("x_mm"),),), source="what the planner writes")
NAMES = ("a", "b")


def written(folder: Path, text: str) -> Path:
    path = folder / "t.csv"
    path.write_text(text, encoding="utf-8")
    return path


def read(folder: Path, text: str) -> Columns:
    return read_table(written(folder, text), TABLE, NAMES)


def refused(folder: Path, text: str) -> str:
    with pytest.raises(UsageError) as caught:
        read(folder, text)
    return str(caught.value)


def test_each_form_gives_its_own_columns(tmp_path: Path) -> None:
    found = read(tmp_path, "who,count\nb,3\na,-4\n")
    assert {name: values.tolist() for name, values in found.values.items()} == {
        "who": [1.0, 0.0],
        "count": [3.0, -4.0],
    }
    assert found.names == NAMES
    assert read(tmp_path, "x_mm,way,note_mm\n1.5,-1,0.5\n").stacked(("way", "x_mm")).tolist() == [[-1.0, 1.5]]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("who,count,x_mm\n", "t.csv:1: both kinds stand in one file; keep either who,count or way,x_mm"),
        ("who,count,volume\n", "t.csv:1: the file holds volumes"),
        (
            "x_mm\n",
            "column way is missing; a way has two ends; the header has to be who,count[,note_mm] or way,x_mm",
        ),
        ("who,count,who\n", "column who stands twice; allowed are who,count[,note_mm] or way,x_mm[,note_mm]"),
        ("who,count,more\n", "unknown column more"),
        ("who,count\n", "t.csv: holds no things; each row below the header line is one thing"),
        ("who,count\nc,1\n", "t.csv:2: unknown who 'c'; the list knows a, b"),
        ("who,count\na,9007199254740993\n", "count = '9007199254740993' is not an integer up to 2^53"),
        ("who,count\na,1_0\n", "count = '1_0' is not an integer"),
        ("way,x_mm\n1,1_000\n", "t.csv:2: x_mm = '1_000' is not a finite number"),
        ("way,x_mm\n1,\n", "t.csv:2: is open"),
        ("way,x_mm,note_mm\n1,2,6\n", "t.csv:2: note_mm = 6 is more than 5 mm: convert it"),
        ("way,x_mm,note_mm\n1,2,inf\n", "t.csv:2: note_mm = 'inf' is not a finite number above 0"),
        ("way,x_mm\n0,nan\n", "t.csv:2: way = '0' is not 1 or -1"),
    ],
)
def test_what_breaks_a_rule_is_named(tmp_path: Path, text: str, said: str) -> None:
    assert said in refused(tmp_path, text)


def test_a_number_far_below_its_limit_is_named_too(tmp_path: Path) -> None:
    far = TableRule("rows", "one", ((ColumnRule("x_mm", unit="mm", largest=1e6, hint="check the unit"),),))
    path = written(tmp_path, "x_mm\n-1e308\n")
    with pytest.raises(UsageError, match=r"t.csv:2: x_mm = -1e\+308 is less than -1e\+06 mm: check the unit"):
        read_table(path, far)


def test_the_first_fault_of_a_file_is_named(tmp_path: Path) -> None:
    assert "t.csv:3: count = 'x'" in refused(tmp_path, "who,count\na,1\na,x\na,1,1\nc,1\n")
    assert "t.csv:3: 3 values" in refused(tmp_path, "who,count\na,1\na,1,1\na,x\n")


def test_rows_keep_their_lines_across_chunks_and_comments(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(csv_lines, "_CHUNK_BYTES", 40)
    lines = [
        "# made by hand",
        "who,count",
        *[f"a,{i}" for i in range(20)],
        "# half",
        "",
        "b,20",
        *["a,21"] * 9,
    ]
    found = read(tmp_path, "\n".join(lines) + "\n")
    assert [lines[line - 1] for line in found.lines] == [
        f"{NAMES[int(who)]},{int(count)}" for who, count in found.stacked(("who", "count"))
    ]
    assert len(list(table_blocks(tmp_path / "t.csv", TABLE, NAMES))) > 3


def test_further_columns_of_an_open_table_are_passed_over(tmp_path: Path) -> None:
    found = read_table(written(tmp_path, "x_mm,remark\n1,\n2,warm\n"), OPEN)
    assert {name: values.tolist() for name, values in found.values.items()} == {"x_mm": [1.0, 2.0]}
    with pytest.raises(UsageError, match="column x_mm is missing: it takes what the planner writes"):
        read_table(written(tmp_path, "y_mm\n1\n"), OPEN)


def test_cells_keep_their_text_beside_the_numbers(tmp_path: Path) -> None:
    rows, columns = read_rows(written(tmp_path, "way,x_mm\n+1,2.50\n"), TABLE)
    assert [dict(row.cells) for row in rows] == [{"way": "+1", "x_mm": "2.50"}]
    assert columns.stacked(("way", "x_mm")).tolist() == [[1.0, 2.5]]


def test_parquet_obeys_the_same_rules(tmp_path: Path) -> None:
    arrow, parquet = (importlib.import_module(name) for name in ("pyarrow", "pyarrow.parquet"))
    path = tmp_path / "t.parquet"
    parquet.write_table(arrow.table({"way": [1, -1], "x_mm": [2.0, 3.0], "more": ["", ""]}), path)
    found = read_table(path, TABLE)
    assert np.array_equal(found.stacked(("way", "x_mm")), [[1.0, 2.0], [-1.0, 3.0]])
    assert found.lines.tolist() == [1, 2]
    parquet.write_table(arrow.table({"way": [1], "x_mm": [2.0], "note_mm": [6.0]}), path)
    with pytest.raises(UsageError, match=r"row 1: note_mm = 6.0 cannot be; it has to be .* at most 5 mm"):
        read_table(path, TABLE)


def test_a_doubled_parquet_column_is_named(tmp_path: Path) -> None:
    arrow, parquet = (importlib.import_module(name) for name in ("pyarrow", "pyarrow.parquet"))
    path = tmp_path / "t.parquet"
    columns = [arrow.array(values) for values in ([1], [2.0], [3.0])]
    parquet.write_table(arrow.table(columns, names=["way", "x_mm", "x_mm"]), path)
    with pytest.raises(UsageError, match=r"t\.parquet: column x_mm stands twice"):
        read_table(path, TABLE)
