"""Returns of a run are distances in measuring order, on every way out of it."""

import csv
import json
from pathlib import Path

import pytest

from catseye.app.cli.export import export
from catseye.app.results.scara.fit_text import distances_text
from catseye.app.results.scara.identify import run_points
from catseye.app.results.scara.measured_distances import measured_distances
from catseye.app.results.scara.points import read_points
from catseye.app.results.scara.table_budget import SeenTable
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import EXTRA, Json, Row, row_of
from tests.unit.app.cli.measured_runs import closure
from tests.unit.app.engine.fakes import distance, point
from tests.unit.app.test_path_comparison import stored

ORDER = [0.0, 1.0, 2.0, 0.0, 3.0, 4.0, 5.0, 0.0]
"""θ1 of six points, with returns to the first one after the third and at the end."""


def rows(**changes: Json) -> list[tuple[str, Row]]:
    points: list[tuple[str, Row]] = [("points", {**point(i), "displacement_mm": 0.1 * i}) for i in range(6)]
    again: Row = {**row_of(distance(0, displacement_mm=0.002)), **changes}
    visit = ("records", closure(again))
    return [*points[:3], visit, *points[3:], visit]


async def run_of(folder: Path) -> RunReader:
    return await stored(folder, "open-loop", rows())


async def test_returns_stand_where_they_were_measured(tmp_path: Path) -> None:
    table = run_points([await run_of(tmp_path)])
    assert table["theta1_deg"].tolist() == ORDER
    assert table["returned"].tolist() == [0, 0, 0, 1, 0, 0, 0, 1]
    assert table["displacement_mm"][[3, 7]].tolist() == [0.002, 0.002]
    assert table.lines.tolist() == list(range(1, 9))


async def test_a_return_has_the_columns_of_a_point(tmp_path: Path) -> None:
    found = measured_distances(await run_of(tmp_path))
    assert set(found[3]) == {*found[0], "returned"} - {EXTRA}


async def test_a_return_belongs_to_the_segment_that_counts(tmp_path: Path) -> None:
    reader = await stored(tmp_path, "open-loop", rows(segment=1, mount_deg=180.0))
    table = run_points([reader])
    assert table["segment"][[0, 3]].tolist() == [0, 1]
    assert table["mount_deg"][[0, 3]].tolist() == [0.0, 180.0]


async def test_segments_of_a_second_run_follow_those_of_returns(tmp_path: Path) -> None:
    first = await stored(tmp_path, "open-loop", rows(segment=1))
    assert set(run_points([first, await run_of(tmp_path)])["segment"][8:]) == {2.0}


async def test_a_run_without_returns_has_no_such_column(tmp_path: Path) -> None:
    reader = await stored(tmp_path, "open-loop", [row for row in rows() if row[0] == "points"])
    assert "returned" not in run_points([reader])


async def test_returns_without_their_whole_distance_are_left_out(tmp_path: Path) -> None:
    early: list[tuple[str, Row]] = [("records", {"kind": "closure", "drift_um": 1.5})]
    reader = await stored(tmp_path, "open-loop", [*rows(displacement_mm=None), *early])
    assert len(measured_distances(reader)) == 6


async def test_returns_without_a_place_are_left_out(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether they were measured before or after a point nobody can say."""
    reader = await run_of(tmp_path)
    placed = reader.placed_rows
    monkeypatch.setattr(reader, "placed_rows", lambda name: [(0, row) for _, row in placed(name)])
    assert [row["theta1_deg"] for row in measured_distances(reader)] == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]


@pytest.mark.parametrize("name", ["points.csv", "points.parquet"])
async def test_tables_have_the_same_rows_and_an_intact_seal(
    tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]
) -> None:
    reader = await run_of(tmp_path)
    export(str(reader.path), tmp_path / name, None, None)
    assert "8 rows (points, 2 of them returns)" in capsys.readouterr().err
    table, seen = read_points(tmp_path / name, ["P1"]), SeenTable(tmp_path / name)
    seen.see(table)
    expected = run_points([reader])
    for column in expected.values:
        assert table[column].tolist() == expected[column].tolist()
    assert seen.intact


async def test_json_has_the_same_rows(tmp_path: Path) -> None:
    reader = await run_of(tmp_path)
    export(str(reader.path), tmp_path / "points.json", None, None)
    found = json.loads((tmp_path / "points.json").read_text(encoding="utf-8"))["points"]
    assert [row["theta1_deg"] for row in found] == ORDER
    assert [row["returned"] for row in found] == [0, 0, 0, 1, 0, 0, 0, 1]


async def test_csv_writes_returns_as_whole_numbers(tmp_path: Path) -> None:
    reader = await run_of(tmp_path)
    export(str(reader.path), tmp_path / "points.csv", None, None)
    lines = [
        line
        for line in (tmp_path / "points.csv").read_text(encoding="utf-8").splitlines()
        if not line.startswith("#")
    ]
    assert [row["returned"] for row in csv.DictReader(lines)] == list("00010001")


def test_counts_say_how_many_are_returns() -> None:
    assert distances_text(1062, 6) == "1062 distances (6 of them returns)"
    assert distances_text(1056, 0) == distances_text(1056, None) == "1056 distances"
