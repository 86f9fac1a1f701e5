"""`predict` and `validate` as processes, on what an emulated tracker has seen; the truth is the bench's true arm."""

import csv
import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.store.catalog import resolve_run
from catseye.simulators.world.tracker import TRACKER_U_MM
from tests.system.command import SPEED, Emulated, catseye, emulated, last_run
from tests.system.test_compensation_round_trip import result_of_the_truth
from tests.system.test_validation_path import true_place, truth

SEED = 3
TAKE_UP_DEG = 1.0

Table = list[dict[str, str]]


@dataclass(frozen=True)
class Seen:
    """What the tracker has seen.

    Attributes:
        folder: with the results, the file of the tracker, and what the commands write.
        table: rows of the file.
        true_mm: where the true arm stands at each row, scatter and radial error motions left out, x + i y.
        seen_mm: where the tracker has seen it, in its own frame, x + i y.
        frame_deg: how far that frame is turned against the robot's.
    """

    folder: Path
    table: Table
    true_mm: np.ndarray[Any, np.dtype[np.complex128]]
    seen_mm: np.ndarray[Any, np.dtype[np.complex128]]
    frame_deg: float


def nominal_result() -> dict[str, Any]:
    """Return the nominal arm as a result."""
    result = result_of_the_truth()
    zero = {"value": 0.0, "u": 0.0}
    links = {name: {"value": value, "u": 0.0} for name, value in (("link1_mm", 325.0), ("link2_mm", 225.0))}
    return result | links | {"model": "conventional", "theta20_mdeg": zero}


def table_of(file: Path) -> Table:
    return list(csv.DictReader(file.read_text(encoding="utf-8").splitlines()))


def column(table: Table, name: str) -> np.ndarray[Any, np.dtype[np.float64]]:
    return np.array([float(row[name]) for row in table])


def typed(row: dict[str, str]) -> dict[str, float | int]:
    states = {name: int(row[name]) for name in ("direction1", "direction2")}
    return {"theta1_deg": float(row["theta1_deg"]), "theta2_deg": float(row["theta2_deg"]), **states}


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    folder = tmp_path_factory.mktemp("tracker")
    (folder / "truth.json").write_text(json.dumps(truth()), encoding="utf-8")
    (folder / "result.json").write_text(json.dumps(result_of_the_truth()), encoding="utf-8")
    (folder / "nominal.json").write_text(json.dumps(nominal_result()), encoding="utf-8")
    with emulated(folder, "--seed", str(SEED), "--truth", "truth.json") as running:
        yield running


@pytest.fixture(scope="module")
def seen(bench: Emulated) -> Seen:
    folder = bench.cell.parent
    lines = [f"--param={key}={value}" for key, value in (("y_from_mm", -400.0), ("y_to_mm", 400.0))]
    lines += ["--param=step_mm=25", "--param=instrument=tracker", "--search=none"]
    done = catseye("run", "validation-path", "--cell", bench.cell, "--speed", SPEED, *lines, cwd=folder)
    assert done.returncode == 0, done.stderr
    run = resolve_run(folder / "catseye-runs", last_run(folder, "validation-path"))
    done = catseye("export", run, "-o", "tracker.csv", cwd=folder)
    assert done.returncode == 0, done.stderr
    table = table_of(folder / "tracker.csv")
    true_mm = np.array([complex(*true_place(typed(row))) for row in table])
    seen_mm = column(table, "x_meas_mm") + 1j * column(table, "y_meas_mm")
    # Where the emulated tracker stands is the first that it draws.
    frame_deg = float(np.random.default_rng([SEED, 9]).normal(0.0, 2.0))
    return Seen(folder, table, true_mm, seen_mm, frame_deg)


def established(table: Table) -> np.ndarray[Any, np.dtype[np.bool_]]:
    """Return the rows whose joints have moved the take-up since they turned, counted joint by joint."""
    flags = np.ones(len(table), dtype=bool)
    for angle, state in (("theta1_deg", "direction1"), ("theta2_deg", "direction2")):
        travelled = np.inf
        for i in range(1, len(table)):
            step = abs(float(table[i][angle]) - float(table[i - 1][angle]))
            travelled = step if table[i][state] != table[i - 1][state] else travelled + step
            flags[i] &= travelled >= TAKE_UP_DEG
    return flags


def test_predicted_positions_are_those_of_the_true_arm(seen: Seen) -> None:
    names = ("theta1_deg", "theta2_deg", "direction1", "direction2")
    lines = [",".join(names), *(",".join(row[name] for name in names) for row in seen.table)]
    (seen.folder / "path.csv").write_text("\n".join(lines), encoding="utf-8")
    options = ("--path", "path.csv", "-o", "predicted.csv", "--json")
    done = catseye("predict", "result.json", *options, cwd=seen.folder)
    assert done.returncode == 0, done.stderr
    facts, rows = json.loads(done.stdout), table_of(seen.folder / "predicted.csv")
    assert facts["rows"] == facts["predicted"] == len(rows) == len(seen.table) == 66
    predicted = column(rows, "x_pred_mm") + 1j * column(rows, "y_pred_mm")
    assert np.abs(predicted - seen.true_mm).max() < 2e-6
    one = np.deg2rad(column(rows, "theta1_deg"))
    both = one + np.deg2rad(column(rows, "theta2_deg"))
    error_um = 1e3 * (seen.true_mm - 325.0 * np.exp(1j * one) - 225.0 * np.exp(1j * both))
    assert np.abs(column(rows, "ex_um") + 1j * column(rows, "ey_um") - error_um).max() < 2e-3
    assert facts["rms_um"] == pytest.approx(np.sqrt(np.mean(np.abs(error_um) ** 2)), rel=1e-6)
    # The result has no uncertainty, so nothing predicted from it has any.
    assert not column(rows, "u_ex_um").any()


def test_validation_finds_the_frame_and_the_expected_residual(seen: Seen) -> None:
    options = ("--measured", "tracker.csv", "--reference", "nominal.json", "-o", "page.html", "--json")
    done = catseye("validate", "result.json", *options, cwd=seen.folder)
    assert done.returncode == 0, done.stderr
    facts = json.loads(done.stdout)
    nominal, model = facts["models"]
    rows = established(seen.table)
    n = int(rows.sum())
    assert (facts["rows"], facts["compared"]) == (66, n)
    assert 50 < n < 66
    # The best turn of one set of points onto another is the phase of their product as complex numbers.
    model_mm, seen_mm = seen.true_mm[rows], seen.seen_mm[rows]
    a, b = seen_mm - seen_mm.mean(), model_mm - model_mm.mean()
    product = np.vdot(a, b)
    left_um = 1e3 * (b - a * product / abs(product))
    assert model["rms_um"] == pytest.approx(np.sqrt(np.mean(np.abs(left_um) ** 2)), rel=1e-5)
    assert model["max_um"] == pytest.approx(np.abs(left_um).max(), rel=1e-5)
    assert model["alignment"]["rotation_mdeg"]["value"] == pytest.approx(
        1e3 * np.degrees(np.angle(product)), abs=1e-3
    )
    # The bench scatters by 22 µm, the path is 400 mm to either side of its middle.
    assert model["alignment"]["rotation_mdeg"]["value"] == pytest.approx(-1e3 * seen.frame_deg, abs=3.0)
    # The result is the truth itself, so the tracker alone makes what is expected, less three degrees of freedom.
    expected_um = 1e3 * TRACKER_U_MM * np.sqrt((2 * n - 3) / n)
    assert model["expected_um"] == pytest.approx(expected_um, rel=1e-6)
    assert model["share_explained"] == pytest.approx((expected_um / model["rms_um"]) ** 2, rel=1e-6)
    # Repeatability (10 µm) and tracker scatter in x and y; radial error motions of 12 µm follow the path.
    assert expected_um * 1.3 < model["rms_um"] < 35.0
    assert facts["ratio"] == pytest.approx(model["rms_um"] / nominal["rms_um"])
    assert facts["ratio"] < 0.4
    page = (seen.folder / "page.html").read_text(encoding="utf-8")
    assert f"{model['rms_um']:.1f}" in page


def test_a_limit_is_an_exit_code(seen: Seen) -> None:
    for limit, code in (("100", 0), ("10", 1)):
        done = catseye(
            "validate", "result.json", "--measured", "tracker.csv", "--limit-um", limit, cwd=seen.folder
        )
        assert done.returncode == code
    assert "more than the limit of 10 µm" in done.stderr


@pytest.mark.parametrize(
    ("scale", "unit"), [(1e-3, "m"), (1e3, "µm"), (1.0 / 25.4, "inches"), (25.4, "converted once too often")]
)
def test_the_trackers_file_in_another_unit_is_refused(seen: Seen, scale: float, unit: str) -> None:
    header = ",".join(seen.table[0])
    lines = [header]
    for row in seen.table:
        scaled = row | {name: str(scale * float(row[name])) for name in ("x_meas_mm", "y_meas_mm")}
        lines.append(",".join(scaled.values()))
    (seen.folder / "other.csv").write_text("\n".join(lines), encoding="utf-8")
    done = catseye("validate", "result.json", "--measured", "other.csv", cwd=seen.folder)
    assert done.returncode == 2
    assert unit in done.stderr
    assert "convert them to mm" in done.stderr
    assert done.stdout == ""


@pytest.mark.parametrize(("command", "option"), [("predict", "--path"), ("validate", "--measured")])
def test_a_file_without_states_of_approach_is_refused(seen: Seen, command: str, option: str) -> None:
    kept = [name for name in seen.table[0] if name != "direction2"]
    lines = [",".join(kept), *(",".join(row[name] for name in kept) for row in seen.table)]
    (seen.folder / "bare.csv").write_text("\n".join(lines), encoding="utf-8")
    done = catseye(command, "result.json", option, "bare.csv", "-o", "none.html", cwd=seen.folder)
    assert done.returncode == 2
    assert "bare.csv:1: column direction2 is missing" in done.stderr
    assert not (seen.folder / "none.html").exists()
