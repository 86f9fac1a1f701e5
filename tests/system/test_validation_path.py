"""The validation path in its three forms on the emulated bench, against a true arm that the test has written down."""

import json
import math
from collections.abc import Iterator

import numpy as np
import pytest

from catseye.app.results.scara.distance_validation import validate_on_distances
from catseye.app.results.scara.path_rows import distance_path
from catseye.app.store.reader import RunReader
from catseye.calibration.core.fit_statistics import FitStatistics
from catseye.calibration.core.types import Floats
from catseye.calibration.scara.identification import Identification
from catseye.calibration.scara.layout import Layout, ModelName
from catseye.procedures.kit.records import Row
from tests.system.command import SPEED, Emulated, catseye, emulated

NODES1, NODES2 = [-150.0, -75.0, 0.0, 75.0, 150.0], [-20.0, 40.0, 100.0, 144.0]
MAP1 = {1: [10.0, -25.0, 5.0, 30.0, -10.0], -1: [32.0, -6.0, 27.0, 49.0, 14.0]}
MAP2 = {1: [-15.0, 25.0, -20.0, 15.0], -1: [4.0, 44.0, 1.0, 37.0]}
PLACES = {"P1": (650.0, -400.0), "P2": (680.0, 0.0), "P3": (640.0, 380.0)}
LINK1, LINK2 = 325.05, 224.96

_SHORT = ("--param", "step_mm=50", "--param", "y_from_mm=-400.0", "--param", "y_to_mm=400.0")


def truth() -> dict[str, object]:
    def table(nodes: list[float], tables: dict[int, list[float]]) -> dict[str, list[float]]:
        return {"node_deg": nodes, "positive_mdeg": tables[1], "negative_mdeg": tables[-1]}

    return {
        "format": "catseye-result/1",
        "link1_mm": {"value": LINK1},
        "link2_mm": {"value": LINK2},
        "theta1_map": table(NODES1, MAP1),
        "theta2_map": table(NODES2, MAP2),
        "reflectors": [
            {"name": name, "x_mm": {"value": x}, "y_mm": {"value": y}} for name, (x, y) in PLACES.items()
        ],
        "theta40_deg": 0.0,
    }


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    folder = tmp_path_factory.mktemp("path")
    (folder / "truth.json").write_text(json.dumps(truth()), encoding="utf-8")
    with emulated(folder, "--seed", "3", "--truth", "truth.json") as running:
        yield running


def driven(bench: Emulated, *options: str, code: int = 0) -> tuple[RunReader, str]:
    arguments = (
        "run",
        "validation-path",
        "--cell",
        bench.cell,
        "--speed",
        SPEED,
        "--search",
        "none",
        *_SHORT,
    )
    done = catseye(*arguments, *options, cwd=bench.cell.parent)
    assert done.returncode == code, done.stderr
    return RunReader(bench.cell.parent / done.stdout.strip()), done.stderr


def real(value: object) -> float:
    assert isinstance(value, (int, float))
    return float(value)


def true_place(row: Row) -> tuple[float, float]:
    """Return where the J4 axis stands in truth, radial error motions and repeatability left out."""
    angles = []
    for theta, state, nodes, tables in (
        (row["theta1_deg"], row["direction1"], NODES1, MAP1),
        (row["theta2_deg"], row["direction2"], NODES2, MAP2),
    ):
        assert isinstance(state, int)
        angles.append(real(theta) + 1e-3 * float(np.interp(real(theta), nodes, tables[state])))
    one, both = math.radians(angles[0]), math.radians(sum(angles))
    return (
        LINK1 * math.cos(one) + LINK2 * math.cos(both),
        LINK1 * math.sin(one) + LINK2 * math.sin(both),
    )


def known_arm(model: ModelName, arm: list[float], nodes: tuple[list[float], list[float]]) -> Identification:
    """Return an arm that is known without a measurement."""
    first, second = (np.deg2rad(one) for one in nodes)
    layout = Layout(model, first, second, tuple(PLACES), ())
    parameters: Floats = np.array([*arm, *np.ravel(list(PLACES.values()))])
    fit = FitStatistics(0, 0, 0, 0.0, 0.0, None, None, None, 1.0, None, 0)
    size = parameters.size
    # Nothing was fitted, so no points belong to it; the comparison looks at neither.
    return Identification(layout, parameters, np.zeros((size, size)), None, np.zeros(0), fit, [])  # type: ignore[arg-type]  # see above


def test_path_distances_distinguish_the_true_map_from_the_nominal_arm(bench: Emulated) -> None:
    reader, _ = driven(bench, "--param", "instrument=interferometer")
    rows = reader.rows("path")
    assert len(rows) == 34
    assert all(row["x_meas_mm"] is None and real(row["signal"]) > 0.1 for row in rows)
    name = str(rows[0]["reflector"])
    counted = np.array([real(row["displacement_mm"]) for row in rows])
    lengths = np.array([math.dist(true_place(row), PLACES[name]) for row in rows])
    # Just after a turn no direction of approach holds; the others differ by what repeats and radial motions leave.
    path = distance_path(reader, 1.0)
    left_um = 1e3 * (counted - lengths)[path.established]
    assert float(np.std(left_um)) < 25.0
    tables = [math.radians(1e-3 * v) for v in (*MAP1[1], *MAP1[-1], *MAP2[1], *MAP2[-1])]
    arms = [
        known_arm("conventional", [325.0, 225.0, 0.0], ([], [])),
        known_arm("error-map", [LINK1, LINK2, *tables], (NODES1, NODES2)),
    ]
    validation = validate_on_distances(path, arms)
    assert validation.ratio is not None
    assert validation.ratio < 0.3
    assert validation.models[1].rms_um == pytest.approx(float(np.std(left_um)), rel=1e-3)
    for command in (["show", reader.path.name], ["report", reader.path.name, "-o", "path.html"]):
        assert catseye(*command, cwd=bench.cell.parent).returncode == 0
    assert "compared with nothing" in (bench.cell.parent / "path.html").read_text(encoding="utf-8")


def test_a_run_resumes_after_its_tracker_file_is_corrected(bench: Emulated) -> None:
    folder = bench.cell.parent
    there = [-400.0 + 50.0 * number for number in range(17)]
    # An instrument beside the robot, turned by a right angle, sees an arm that is up to 0.3 mm off.
    seen = [(y, 2000.0 - y + 0.3 * math.sin(y), 900.0) for y in (*there, *reversed(there))]

    def written(name: str, scale: float) -> None:
        lines = [f"200,{y},{scale * x_meas},{scale * y_meas}" for y, x_meas, y_meas in seen]
        text = "\n".join(["# institute's tracker", "x_mm,y_mm,x_meas_mm,y_meas_mm", *lines])
        (folder / name).write_text(text, encoding="utf-8")
        (folder / f"{name}.toml").write_text(f'measured-file = "{name}"\n', encoding="utf-8")

    written("metres.csv", 1e-3)
    written("good.csv", 1.0)
    options = ("--param", "instrument=file", "--param", "hold_time_s=1.0", "--answers")
    failed, said = driven(bench, *options, "metres.csv.toml", code=4)
    assert "metres.csv: the measured positions are spread 0.001" in said
    assert "they seem to be in m: convert them to mm" in said
    assert failed.rows("path") == []
    done = catseye("resume", failed.path.name, "--answers", "good.csv.toml", cwd=folder)
    assert done.returncode == 0, done.stderr
    for row, (y, x_meas, y_meas) in zip(failed.rows("path"), seen, strict=True):
        assert (row["y_mm"], row["x_meas_mm"], row["y_meas_mm"], row["u_mm"]) == (y, x_meas, y_meas, None)


def test_the_rehearsal_states_speeds_beam_and_miss(bench: Emulated) -> None:
    arguments = (
        "run",
        "validation-path",
        "--cell",
        bench.cell,
        "--search",
        "none",
        "--dry-run",
        "--json",
        *_SHORT,
    )
    done = catseye(*arguments, "--param", "instrument=interferometer", cwd=bench.cell.parent)
    assert done.returncode == 0, done.stderr
    rehearsed = json.loads(done.stdout)
    assert 0.05 < rehearsed["miss_mm"] <= rehearsed["max_miss_mm"] == 0.2
    assert (rehearsed["override_percent"], rehearsed["warnings"], rehearsed["questions"]) == (20, [], [])
    steps = rehearsed["steps"]
    # 20 % of 420, 720 and 3000 deg/s.
    assert all(0.0 <= step["joint_deg_s"] <= 600.0 for step in steps)
    one, two, _, _ = steps[0]["end"]
    place = (
        325.0 * math.cos(math.radians(one)) + 225.0 * math.cos(math.radians(one + two)),
        325.0 * math.sin(math.radians(one)) + 225.0 * math.sin(math.radians(one + two)),
    )
    assert place == pytest.approx((200.0, -400.0), abs=1e-2)
    assert any(
        steps[0]["beam_mm"] == pytest.approx(math.dist(place, where), abs=0.1) for where in PLACES.values()
    )
    assert "the beam misses by" in done.stderr
