"""A stored path finds the measurement it belongs to."""

import math
import tomllib
from pathlib import Path

import numpy as np

from catseye.app.cell.model import Cell
from catseye.app.cell.scara.template import TEMPLATE
from catseye.app.results.scara.path_of_run import compare_path
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
