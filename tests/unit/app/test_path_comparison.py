"""A stored path finds the measurement it belongs to."""

import json
import math
import tomllib
from pathlib import Path

import numpy as np
import pytest

from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.cli.export import export
from catseye.app.cli.scara.identify import identify
from catseye.app.cli.validate import validate
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.results.scara.path_of_run import compare_path
from catseye.app.results.scara.result import read_result
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.procedures.kit.records import Json, Row
from tests.unit.app.engine.fakes import point
from tests.unit.app.store.fakes import RECORDS, TickingClock
from tests.unit.app.test_distance_validation import COUNT, TRUTH, commands, true_length, true_place
from tests.unit.calibration.scara.paper import NODES1_DEG, NODES2_DEG, sequence, true_position

META: dict[str, Json] = {
    "cell": "lab-1",
    "configuration": Cell.model_validate(tomllib.loads(TEMPLATE)).model_dump(mode="json"),
    "aim": "cell file",
    "simulated": True,
}


async def stored(root: Path, procedure: str, rows: list[tuple[str, Row]], **meta: Json) -> RunReader:
    store = await RunStore.create(
        root, procedure, {**META, **meta}, TickingClock(), records=RECORDS, reserve_bytes=0
    )
    await store.append_step("rows", 1, "rows", {}, rows)
    await store.finish("complete", 0)
    return RunReader(store.path)


def measured() -> list[tuple[str, Row]]:
    """Return the paper's measurement of the true arm to one reflector."""
    rows: list[tuple[str, Row]] = []
    for command in sequence():
        i1, i2, s1, s2 = command
        length = math.dist(true_position(TRUTH, command), TRUTH.reflectors[1])
        theta = {
            "theta1_deg": NODES1_DEG[i1],
            "theta2_deg": NODES2_DEG[i2],
            "direction1": s1,
            "direction2": s2,
        }
        rows.append(("points", {**point(), **theta, "reflector": "P2", "displacement_mm": length}))
    return rows


def along(number: int) -> Row:
    one, two, s1, s2 = commands()[number]
    y_mm = float(min(number, COUNT - 1 - number))
    theta: Row = {"theta1_deg": one, "theta2_deg": two, "direction1": s1, "direction2": s2}
    return {**theta, "x_mm": 200.0, "y_mm": y_mm, "pass_number": 0}


def distances() -> list[tuple[str, Row]]:
    lengths = [true_length(TRUTH, row, 1) for row in commands()]
    return [
        ("path", {**along(i), "reflector": "P2", "segment": 0, "displacement_mm": length - 300.0})
        for i, length in enumerate(lengths)
    ]


async def test_the_newest_measurement_of_the_same_bench_gives_the_models(tmp_path: Path) -> None:
    reader = await stored(tmp_path, "validation-path", distances())
    assert "compared with nothing" in compare_path(reader, tmp_path).notes[0]
    assert "(cell file)" in compare_path(reader, tmp_path).notes[0]
    await stored(tmp_path, "open-loop", measured()[:20], aim="another search")
    right = await stored(tmp_path, "open-loop", measured())
    found = compare_path(reader, tmp_path)
    assert found.notes == [f"the models on the path were identified from {right.path.name}"]
    assert [result.model for result in found.results] == ["conventional", "error-map"]
    assert found.validation is None
    assert found.distances is not None
    assert found.distances.ratio is not None
    assert found.distances.ratio < 1e-3


async def test_a_measurement_that_determines_nothing_is_reported(tmp_path: Path) -> None:
    reader = await stored(tmp_path, "validation-path", distances())
    poor = await stored(tmp_path, "open-loop", measured()[:20])
    found = compare_path(reader, tmp_path)
    assert (found.results, found.distances) == ([], None)
    assert found.notes[0].startswith(f"the path cannot be compared with the models of {poor.path.name}: ")


async def test_a_left_handed_frame_is_reported(tmp_path: Path) -> None:
    seen = [true_place(TRUTH, row) for row in commands()]
    await stored(tmp_path, "open-loop", measured())

    async def notes(axes: int) -> list[str]:
        places: list[tuple[str, Row]] = [
            ("path", {**along(i), "x_mm": x, "y_mm": y, "x_meas_mm": x, "y_meas_mm": axes * y, "u_mm": 0.01})
            for i, (x, y) in enumerate(seen)
        ]
        return compare_path(await stored(tmp_path, "validation-path", places), tmp_path).notes

    assert len(await notes(1)) == 1
    assert "with x and y exchanged: the instrument's frame seems to be left-handed" in (await notes(-1))[-1]


async def test_positions_are_compared_too(tmp_path: Path) -> None:
    # An instrument in a frame of its own, turned by a right angle, that states no uncertainty.
    seen = [true_place(TRUTH, row) for row in commands()]
    places: list[tuple[str, Row]] = [
        ("path", {**along(i), "x_mm": x, "y_mm": y, "x_meas_mm": 900.0 - y, "y_meas_mm": x, "u_mm": None})
        for i, (x, y) in enumerate(seen)
    ]
    reader = await stored(tmp_path, "validation-path", places)
    await stored(tmp_path, "open-loop", measured())
    found = compare_path(reader, tmp_path)
    assert found.distances is None
    assert found.validation is not None
    conventional, error_map = found.validation.models
    assert conventional.comparison.rms_2d_um > 20.0
    assert error_map.comparison.rms_2d_um < 0.01
    assert np.isnan(found.validation.path.u_mm).all()


def positions() -> list[tuple[str, Row]]:
    places = [true_place(TRUTH, row) for row in commands()]
    return [
        ("path", {**along(i), "x_meas_mm": x, "y_meas_mm": y, "u_mm": 0.01})
        for i, (x, y) in enumerate(places)
    ]


async def identified(folder: Path) -> tuple[RunReader, Path]:
    """Return a path measured by distances, and the error map of the run before it."""
    root = folder / "runs"
    path = await stored(root, "validation-path", distances())
    run = await stored(root, "open-loop", measured())
    result = folder / "map.json"
    identify(result, [run.path.name], runs=root)
    return path, result


async def test_a_result_is_validated_on_the_distances_of_a_run(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, result = await identified(tmp_path)
    capsys.readouterr()
    page = tmp_path / "validation.html"
    validate(result, Path(path.path.name), runs=path.path.parent, output=page, limit=1.0, as_json=True)
    said = json.loads(capsys.readouterr().out)
    assert [one["model"] for one in said["models"]] == ["conventional", "error-map"]
    # The distances come from the arm that was measured, without noise: what is left is the computer's rounding.
    assert said["models"][1]["rms_um"] < 0.1
    assert said["models"][0]["rms_um"] > 10.0
    assert said["within_limit"] is True
    assert "SIMULATION" in page.read_text(encoding="utf-8")


async def test_a_limit_on_distances_that_is_exceeded_rejects(tmp_path: Path) -> None:
    path, result = await identified(tmp_path)
    conventional = tmp_path / "conventional.json"
    known = read_result(result).provenance.runs
    identify(conventional, known, runs=path.path.parent, model="conventional")
    with pytest.raises(MeasurementRejectedError, match="rms of distances"):
        validate(conventional, Path(path.path.name), runs=path.path.parent, limit=1.0)


async def test_a_result_of_other_points_is_not_validated_on_distances(tmp_path: Path) -> None:
    path, result = await identified(tmp_path)
    changed = json.loads(result.read_text(encoding="utf-8"))
    changed["link1_mm"]["value"] += 1.0
    result.write_text(json.dumps(changed), encoding="utf-8")
    with pytest.raises(UsageError, match="is not what"):
        validate(result, Path(path.path.name), runs=path.path.parent)
    changed["provenance"]["runs"] = ["20261121T080000Z_open-loop_00beef"]
    result.write_text(json.dumps(changed), encoding="utf-8")
    with pytest.raises(UsageError, match="00beef"):
        validate(result, Path(path.path.name), runs=path.path.parent)


async def test_positions_of_a_run_are_validated_like_their_export(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    _, result = await identified(tmp_path)
    root = tmp_path / "runs"
    run = await stored(root, "validation-path", positions())
    capsys.readouterr()
    validate(result, Path(run.path.name), runs=root, as_json=True)
    by_run = json.loads(capsys.readouterr().out)
    exported = tmp_path / "path.csv"
    export(run.path.name, exported, runs=root)
    validate(result, exported, as_json=True)
    assert by_run["models"] == json.loads(capsys.readouterr().out)["models"]


async def test_a_run_is_compared_with_the_conventional_model_beside(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path, result = await identified(tmp_path)
    known = read_result(result).provenance.runs
    identify(tmp_path / "links.json", known, runs=path.path.parent, model="conventional")
    run = await stored(path.path.parent, "validation-path", positions())
    capsys.readouterr()
    validate(result, Path(run.path.name), runs=path.path.parent, as_json=True)
    captured = capsys.readouterr()
    assert [one["model"] for one in json.loads(captured.out)["models"]] == ["conventional", "error-map"]
    assert "links.json" in captured.err
