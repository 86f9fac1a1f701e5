"""What is exported is what was measured, and what this program writes it reads again."""

import csv
import importlib
import io
import json
from pathlib import Path

import pytest

from catseye.app.cli.export import export, form_of
from catseye.app.errors import ConfigError, UsageError
from catseye.app.files.columns import read_table
from catseye.app.files.tabular import table_csv, table_parquet
from catseye.app.results.scara.export import Export, result_export, result_rows, run_export
from catseye.app.results.scara.identify import run_points
from catseye.app.results.scara.points import read_points
from catseye.app.results.scara.result import TermEstimate, write_result
from catseye.app.results.scara.table_budget import SeenTable
from catseye.procedures.kit.records import Json, Row
from catseye.procedures.scara.path.tables import MEASURED
from tests.unit.app.engine.fakes import point
from tests.unit.app.results.scara import sample
from tests.unit.app.test_path_comparison import distances, stored


def lines(text: str) -> list[dict[str, str]]:
    return list(csv.DictReader(io.StringIO(text)))


def read_again(tmp_path: Path, export: Export) -> Path:
    path = tmp_path / "again.csv"
    path.write_text(export.csv, encoding="utf-8")
    return path


async def test_exported_distances_round_trip_exactly_with_sigma(tmp_path: Path) -> None:
    given = [
        {
            **point(),
            "reflector": "P2",
            "segment": i // 3,
            "displacement_mm": 100.0 / 3.0 + i,
            "direction2": -1,
        }
        for i in range(6)
    ]
    reader = await stored(tmp_path, "open-loop", [("points", row) for row in given])
    rows = read_points(read_again(tmp_path, run_export(reader)), ["P2"])
    assert rows["displacement_mm"].tolist() == [row["displacement_mm"] for row in given]
    assert rows["segment"].tolist() == [0, 0, 0, 1, 1, 1]
    assert set(rows["direction2"]) == {-1}
    # Of Table 2 in a distance of 743 mm what differs from distance to distance: 10 µm, all else below 0.4 µm.
    assert rows["sigma_mm"] == pytest.approx([0.01001] * 6, abs=5e-6)


@pytest.mark.parametrize("name", ["points.csv", "points.parquet"])
async def test_exported_mountings_are_read_again_with_an_intact_budget(tmp_path: Path, name: str) -> None:
    given = [{**point(i), "segment": i // 3, "mount_deg": 180.5 if i > 2 else None} for i in range(6)]
    reader = await stored(tmp_path, "open-loop", [("points", row) for row in given])
    export(str(reader.path), tmp_path / name, None, None)
    rows, seen = read_points(tmp_path / name, ["P1"]), SeenTable(tmp_path / name)
    seen.see(rows)
    assert rows["mount_deg"].tolist() == [0.0] * 3 + [180.5] * 3
    assert rows["mount_deg"].tolist() == run_points([reader])["mount_deg"].tolist()
    assert seen.intact


async def test_json_holds_the_mountings(tmp_path: Path) -> None:
    given = [{**point(i), "segment": i, "mount_deg": 180.5 * i} for i in range(2)]
    reader = await stored(tmp_path, "open-loop", [("points", row) for row in given])
    export(str(reader.path), tmp_path / "points.json", None, None)
    document = json.loads((tmp_path / "points.json").read_text(encoding="utf-8"))
    assert [row["mount_deg"] for row in document["points"]] == [0.0, 180.5]


@pytest.mark.parametrize("name", ["points.csv", "points.parquet"])
async def test_without_a_turned_interferometer_no_column_says_so(tmp_path: Path, name: str) -> None:
    given: list[Row] = [{**point(i), "mount_deg": [None, 0.0][i % 2]} for i in range(6)]
    reader = await stored(tmp_path, "open-loop", [("points", row) for row in given])
    export(str(reader.path), tmp_path / name, None, None)
    assert "mount_deg" not in read_points(tmp_path / name, ["P1"])


async def test_positions_of_a_path_are_a_measured_file(tmp_path: Path) -> None:
    place: Row = {
        "theta1_deg": -10.0,
        "theta2_deg": 70.0,
        "direction1": 1,
        "direction2": -1,
        "pass_number": 0,
    }
    seen: list[Json] = [200.25, 201.125]
    given = [
        {**place, "x_mm": 200.0, "y_mm": 1.0, "x_meas_mm": x, "y_meas_mm": 1.5, "u_mm": 0.0085} for x in seen
    ]
    reader = await stored(tmp_path, "validation-path", [("path", row) for row in given])
    rows = read_table(read_again(tmp_path, run_export(reader)), MEASURED)
    assert rows.stacked(("x_meas_mm", "y_meas_mm", "u_mm")).tolist() == [[x, 1.5, 0.0085] for x in seen]
    commands = rows.stacked(("theta1_deg", "theta2_deg", "direction1", "direction2"))
    assert commands[0].tolist() == [-10.0, 70.0, 1.0, -1.0]


async def test_an_instrument_without_uncertainty_gives_no_column_for_it(tmp_path: Path) -> None:
    row: Row = {"theta1_deg": -10.0, "theta2_deg": 70.0, "direction1": 1, "direction2": -1}
    place: Row = {"x_mm": 200.0, "y_mm": 1.0, "x_meas_mm": 200.1, "y_meas_mm": 1.5}
    reader = await stored(tmp_path, "validation-path", [("path", {**row, **place})])
    assert "u_mm" not in read_table(read_again(tmp_path, run_export(reader)), MEASURED)


async def test_a_corrected_path_keeps_line_and_wished_positions(tmp_path: Path) -> None:
    theta: Row = {"theta1_deg": 20.0, "theta2_deg": 40.0, "direction1": 1, "direction2": -1}
    place: Row = {"x_mm": 200.0, "y_mm": 1.0, "x_meas_mm": 200.1, "y_meas_mm": 1.5, "u_mm": 0.01, "line": 3}
    params: Json = {"joints": [{**theta, "x_mm": 200.0, "y_mm": 1.0}]}
    reader = await stored(tmp_path, "validation-path", [("path", {**place, **theta})], params=params)
    rows = read_table(read_again(tmp_path, run_export(reader)), MEASURED)
    assert rows.stacked(("line", "x_wished_mm", "y_wished_mm")).tolist() == [[3.0, 200.0, 1.0]]


async def test_distances_along_a_path_are_a_points_file(tmp_path: Path) -> None:
    reader = await stored(tmp_path, "validation-path", distances())
    export = run_export(reader)
    rows = read_points(read_again(tmp_path, export), ["P2"])
    assert export.content == "path"
    assert rows["displacement_mm"].tolist() == [row["displacement_mm"] for _, row in distances()]


async def test_sightings_and_records_are_exported_with_all_their_columns(tmp_path: Path) -> None:
    sighting: Row = {"reflector": "P1", "theta1_deg": 1.0, "theta2_deg": 2.0, "j4_deg": 3.0}
    reader = await stored(tmp_path, "reflector-search", [("search", sighting)])
    found = lines(run_export(reader).csv)[0]
    assert (found["reflector"], found["j4_deg"], found["signal"]) == ("P1", "3.0", "")
    kinds: list[Row] = [{"kind": "drift", "um": 1.5}, {"kind": "repeat", "cycle": 2, "xy_mm": [1.0, 2.0]}]
    reader = await stored(tmp_path, "repeatability", [("records", row) for row in kinds])
    rows = lines(run_export(reader).csv)
    assert [row["kind"] for row in rows] == ["drift", "repeat"]
    assert (rows[0]["um"], rows[0]["cycle"], rows[1]["cycle"], rows[1]["xy_mm"]) == (
        "1.5",
        "",
        "2",
        "[1.0, 2.0]",
    )


async def test_a_run_that_measured_nothing_says_so(tmp_path: Path) -> None:
    reader = await stored(tmp_path, "open-loop", [])
    with pytest.raises(UsageError, match="holds nothing to export: it is complete"):
        run_export(reader)


def test_every_result_value_has_its_unit_and_uncertainty(tmp_path: Path) -> None:
    result = sample.hand_made()
    write_result(result, tmp_path / "result.json")
    export = result_export(tmp_path / "result.json")
    rows = lines(export.csv)
    assert list(rows[0]) == ["quantity", "node_deg", "direction", "value", "unit", "u"]
    assert list(rows[0].values()) == ["L1", "", "", "324.964123", "mm", "0.00234"]
    node = next(
        row for row in rows if (row["quantity"], row["node_deg"], row["direction"]) == ("Δθ1", "0.0", "-1")
    )
    assert (node["value"], node["unit"], node["u"]) == ("-6.543", "mdeg", "0.65")
    # 2 links, 2 joints × 2 directions × 3 nodes, 1 reflector, 1 dead path.
    assert len(rows) == 2 + 12 + 2 + 1
    assert rows[-1]["quantity"] == "dead path P1/0"
    assert export.about["gauge"] == result.gauge


def test_terms_beyond_the_maps_are_rows_too() -> None:
    term = TermEstimate(
        target="link1", source="elapsed", part="linear", order=1, unit="um", value=12.0, u=3.0
    )
    result = sample.hand_made().model_copy(update={"extension": [term]})
    row = next(row for row in result_rows(result) if row["quantity"] == "ΔL1 t")
    assert (row["value"], row["unit"], row["u"]) == (12.0, "µm", 3.0)


def test_parquet_is_read_back_as_it_was_written() -> None:
    parquet = importlib.import_module("pyarrow.parquet")
    rows: list[dict[str, object]] = [{"a": 1, "b": 0.1, "c": "x"}, {"a": 2, "b": 1, "d": [1, 2]}, {"c": 5}]
    read = parquet.read_table(io.BytesIO(table_parquet(rows))).to_pylist()
    assert read == [
        {"a": 1, "b": 0.1, "c": "x", "d": None},
        {"a": 2, "b": 1.0, "c": None, "d": "[1, 2]"},
        {"a": None, "b": None, "c": "5", "d": None},
    ]


def test_parquet_of_a_result_holds_its_numbers_as_numbers(tmp_path: Path) -> None:
    parquet = importlib.import_module("pyarrow.parquet")
    write_result(sample.hand_made(), tmp_path / "result.json")
    export(str(tmp_path / "result.json"), tmp_path / "result.parquet", None, None)
    # From bytes: a path is closed by a thread of the reader's own, some time after it returns.
    table = parquet.read_table(io.BytesIO((tmp_path / "result.parquet").read_bytes()))
    assert [str(table.schema.field(name).type) for name in ("node_deg", "direction", "value", "unit")] == [
        "double",
        "int64",
        "double",
        "string",
    ]
    assert table.column("value")[0].as_py() == 324.964123


def test_parquet_without_its_package_names_the_remedy(monkeypatch: pytest.MonkeyPatch) -> None:
    def missing(name: str) -> None:
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", missing)
    with pytest.raises(ConfigError, match=r"pip install 'catseye\[parquet\]'"):
        table_parquet([{"a": 1}])


async def test_json_holds_the_whole_record(tmp_path: Path) -> None:
    reader = await stored(tmp_path, "validation-path", distances())
    export(str(reader.path), tmp_path / "path.json", None, None)
    document = json.loads((tmp_path / "path.json").read_text(encoding="utf-8"))
    assert (document["run"], document["meta"]["cell"]) == (reader.path.name, "lab-1")
    assert len(document["path"]) == len(distances())


def test_the_ending_says_the_format_and_may_not_contradict_it() -> None:
    assert form_of(Path("a.CSV"), None) == "csv"
    assert form_of(Path("a.dat"), "parquet") == "parquet"
    with pytest.raises(UsageError, match=r"a\.json would hold csv.*-o a\.csv or --format json"):
        form_of(Path("a.json"), "csv")
    with pytest.raises(UsageError, match="say what to write"):
        form_of(Path("a.dat"), None)


def test_a_result_is_never_overwritten_by_its_own_export(tmp_path: Path) -> None:
    path = tmp_path / "result.json"
    write_result(sample.hand_made(), path)
    before = path.read_bytes()
    with pytest.raises(UsageError, match="is the result itself"):
        export(str(path), path, "json", None)
    assert path.read_bytes() == before
    with pytest.raises(UsageError, match="there is no such file"):
        export(str(tmp_path / "missing.json"), tmp_path / "a.csv", None, None)


def test_names_with_commas_and_quotes_survive() -> None:
    assert lines(table_csv([{"name": 'a,"b"\nc', "on": True}])) == [{"name": 'a,"b"\nc', "on": "True"}]
