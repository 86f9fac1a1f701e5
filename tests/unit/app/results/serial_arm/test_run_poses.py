"""Runs as poses: world frame, drift of the nests, calibration and validation from runs alone."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from catseye.app.cell.model import Cell
from catseye.app.cli import cli
from catseye.app.errors import UsageError
from catseye.app.results.runs.summary import summary
from catseye.app.results.serial_arm.run_poses import pose_export, pose_notes, pose_rows
from catseye.app.store.reader import RunReader
from catseye.drivers.roles.errors import LinkError
from catseye.procedures.serial_arm.ballbar import BallbarTest
from catseye.procedures.serial_arm.bench import SerialBench
from catseye.procedures.serial_arm.tracker_calibration import CalibrationParams, TrackerCalibration
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams
from tests.unit.app.render.page_reader import read_page
from tests.unit.procedures.serial_arm.benches import CMM, NESTS, SIX, TARGETS, Room, carried_out
from tests.unit.procedures.serial_arm.test_ballbar import plan_of as ballbar_plan

TOOL = "\n".join(
    [
        'format = "catseye-tool/1"',
        'name = "plate"',
        "mass_kg = 2.7",
        "centre_mm = [50.0, 25.0, 100.0]",
        *(
            f'[[target]]\nname = "{one.name}"\nx_mm = {one.place_mm[0]}\ny_mm = {one.place_mm[1]}\n'
            f"z_mm = {one.place_mm[2]}\nnormal = {list(one.normal or ())}"
            for one in TARGETS
        ),
    ]
)


def configuration(folder: Path) -> Any:
    tool = folder / "plate.toml"
    tool.write_text(TOOL, encoding="utf-8")
    cell = {
        "format": "catseye-cell/1",
        "name": "lab-1",
        "robot": {
            "driver": "kuka-varproxy",
            "endpoint": "tcp://127.0.0.1:7000",
            "arm": "irb120",
            "tool": str(tool),
        },
    }
    return Cell.model_validate(cell).model_dump(mode="json")


async def measured(
    room: Room, folder: Path, procedure: Any, params: Any, bench: SerialBench | None = None
) -> Path:
    plan = procedure.plan(bench or SIX, params)
    meta = {"configuration": configuration(folder), "procedure": procedure.name}
    outcome = await carried_out(room, procedure, plan, meta=meta)
    assert (outcome.status, outcome.text) == ("complete", "")
    return outcome.path


async def validated(tmp_path: Path, room: Room | None = None) -> Path:
    runs = tmp_path / "runs"
    runs.mkdir(exist_ok=True)
    room = room or Room(runs)
    params = ValidationParams(count=8, nests_every=4, settle_s=0.2)
    return await measured(room, tmp_path, TrackerValidation(), params)


def place_of(row: Any) -> np.ndarray:
    return np.array([row[name] for name in ("x_mm", "y_mm", "z_mm")], dtype=np.float64)


def in_world(place: np.ndarray) -> np.ndarray:
    """Return a place in the frame of the first nest, by the geometry of the three: two sides at right angles."""
    w1, w2, w3 = (np.array(NESTS[name]) for name in ("W1", "W2", "W3"))
    x = (w2 - w1) / np.linalg.norm(w2 - w1)
    y = (w3 - w2) / np.linalg.norm(w3 - w2)
    return np.array([(place - w1) @ x, (place - w1) @ y, (place - w1) @ np.cross(x, y)])


async def test_places_stand_in_the_world_frame(tmp_path: Path) -> None:
    reader = RunReader(await validated(tmp_path))
    rows, raw = pose_rows(reader), reader.rows("targets")
    for row, stored in zip(rows, raw, strict=True):
        place = np.array([stored["x_mm"], stored["y_mm"], stored["z_mm"]], dtype=np.float64)
        assert [row["x_mm"], row["y_mm"], row["z_mm"]] == pytest.approx(in_world(place), abs=1e-9)
        assert [row[f"q{k}_deg"] for k in range(1, 7)] == stored["q"]
        assert [row[f"q{k}_read_deg"] for k in range(1, 7)] == stored["q_read"]
    # Axes of the world are those of the tracker, exchanged: variances go along.
    assert [rows[0][name] for name in ("u_x_mm", "u_y_mm", "u_z_mm")] == pytest.approx([0.03, 0.02, 0.04])


async def test_an_instrument_moved_while_interrupted_moves_no_place(tmp_path: Path) -> None:
    for name in ("still", "moved"):
        (tmp_path / name).mkdir()
    still = pose_rows(RunReader(await validated(tmp_path / "still", Room(tmp_path / "still"))))
    room = Room(tmp_path / "moved")
    measure = room.tracker.point

    async def failing(*args: Any, **kwargs: Any) -> Any:
        if len(room.tracker.asked) == 5:
            raise LinkError("the tracker does not answer")
        return await measure(*args, **kwargs)

    room.tracker.point = failing  # type: ignore[method-assign]  # answers five times
    plan = TrackerValidation().plan(SIX, ValidationParams(count=8, nests_every=4, settle_s=0.2))
    meta = {"configuration": configuration(tmp_path), "procedure": TrackerValidation.name}
    first = await carried_out(room, TrackerValidation(), plan, meta=meta)
    again = Room(tmp_path / "moved")
    again.robot.pose, again.tracker.drift_mm = room.robot.pose, {-1: 0.5}
    await carried_out(again, TrackerValidation(), plan, meta=meta, resume=first.path)
    reader = RunReader(first.path)
    assert [row["nests_round"] for row in reader.rows("targets")] == [0, 0, 1, 1, 2, 2, 2, 2]
    for row, kept in zip(pose_rows(reader), still, strict=True):
        assert place_of(row) == pytest.approx(place_of(kept), abs=1e-9)
    assert any("has moved by 0.500 mm" in str(one["text"]) for one in again.said("warning"))


async def test_stated_covariances_turn_into_the_world_frame(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    room = Room(runs)
    room.tracker.covariance_mm2 = (1e-4, -2e-4, 3e-4)
    reader = RunReader(await validated(tmp_path, room))
    stated = np.array([[4e-4, 1e-4, -2e-4], [1e-4, 9e-4, 3e-4], [-2e-4, 3e-4, 16e-4]])
    # Three places in the world whose differences are the axes of the tracker.
    axes = np.array([in_world(one) - in_world(np.zeros(3)) for one in np.eye(3)]).T
    wanted = axes @ stated @ axes.T
    for row in pose_rows(reader):
        names = (("u_x_mm", 0), ("u_y_mm", 1), ("u_z_mm", 2))
        assert [row[name] for name, _ in names] == pytest.approx([wanted[k, k] ** 0.5 for _, k in names])
        found = [row[name] for name in ("cov_xy_mm2", "cov_xz_mm2", "cov_yz_mm2")]
        assert found == pytest.approx([wanted[0, 1], wanted[0, 2], wanted[1, 2]])
    assert not pose_notes(reader)


async def test_covariances_that_nobody_states_are_named(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    room = Room(runs)
    room.tracker.covariance_mm2 = None
    (note,) = pose_notes(RunReader(await validated(tmp_path, room)))
    assert "states no covariances for 8 of 8 places" in note


async def test_unstated_covariances_are_no_columns(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    room = Room(runs)
    room.tracker.covariance_mm2, room.tracker.hidden = None, {"W2": 99}
    row = pose_rows(RunReader(await validated(tmp_path, room)))[0]
    # In the instrument's frame nothing turns them.
    assert [row[name] for name in ("u_x_mm", "u_y_mm", "u_z_mm")] == [0.02, 0.03, 0.04]
    assert "cov_xy_mm2" not in row


async def test_a_drift_of_the_instrument_is_taken_out(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    still = pose_rows(RunReader(await validated(tmp_path, Room(runs))))
    room = Room(runs)
    # After the first four poses the instrument is pushed: everything seems to have moved by a millimetre.
    room.tracker.drift_mm = {7: 1.0}
    moved = pose_rows(RunReader(await validated(tmp_path, room)))
    for row, other in zip(still, moved, strict=True):
        assert [other[name] for name in ("x_mm", "y_mm", "z_mm")] == pytest.approx(
            [row[name] for name in ("x_mm", "y_mm", "z_mm")], abs=1e-6
        )


async def test_noise_of_the_nests_is_no_drift(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    room = Room(runs)
    # Less than the stated uncertainty of the nests: 0.03 mm a coordinate.
    room.tracker.drift_mm = {7: 0.02}
    moved = pose_rows(RunReader(await validated(tmp_path, room)))
    still = pose_rows(RunReader(await validated(tmp_path, Room(runs))))
    apart = [np.linalg.norm(place_of(one) - place_of(other)) for one, other in zip(moved, still, strict=True)]
    # The mean of the nests moves, and later places against it: nothing turns, nothing is amplified.
    assert max(apart) <= 0.02 + 1e-9


async def test_a_run_is_exported_calibrated_and_validated(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    params = CalibrationParams(count=14, candidates=300, model="geometric", settle_s=0.2)
    first = await measured(Room(runs), tmp_path, TrackerCalibration(), params)
    second = await validated(tmp_path)
    runner, result, table = CliRunner(), tmp_path / "arm.json", tmp_path / "poses.csv"
    done = runner.invoke(cli, ["export", first.name, "--runs", str(runs), "-o", str(table)])
    assert done.exit_code == 0, done.output
    assert table.read_text(encoding="utf-8").splitlines()[0].startswith("pose,q1_deg,q2_deg")
    command = ["calibrate", first.name, "--runs", str(runs), "--model", "frames", "-o", str(result)]
    done = runner.invoke(cli, command)
    assert done.exit_code == 0, done.output
    document = json.loads(result.read_text(encoding="utf-8"))
    assert document["arm"] == "irb120"
    assert document["provenance"]["runs"] == [first.name]
    assert document["provenance"]["simulated"] is True
    # A run by its name, and by its folder, as it was printed at its end.
    for measured_at in ([second.name, "--runs", str(runs)], [str(second)]):
        done = runner.invoke(cli, ["validate", str(result), "--measured", *measured_at, "--json"])
        assert done.exit_code == 0, done.output
        found = json.loads(done.stdout)
        # The scripted arm is as it is drawn.
        assert found["n"] == 8
        assert found["calibrated"]["max_mm"] < 1e-6
    # A run of emulators marks the page, also where nobody knows where the result comes from.
    document["provenance"] = None
    result.write_text(json.dumps(document), encoding="utf-8")
    page = tmp_path / "page.html"
    done = runner.invoke(cli, ["validate", str(result), "--measured", str(second), "-o", str(page)])
    assert done.exit_code == 0, done.output
    assert "SIMULATION" in read_page(page.read_text(encoding="utf-8")).text


async def cmm_run(tmp_path: Path, procedure: Any, params: Any, **stated: Any) -> Path:
    runs = tmp_path / "runs"
    runs.mkdir(exist_ok=True)
    room = Room(runs)
    for name, u in stated.items():
        setattr(room.tracker, name, u)
    return await measured(room, tmp_path, procedure, params, CMM)


async def test_a_cmm_run_is_calibrated_and_validated(tmp_path: Path) -> None:
    params = CalibrationParams(count=14, candidates=300, model="geometric", settle_s=0.2)
    first = await cmm_run(tmp_path, TrackerCalibration(), params)
    second = await cmm_run(tmp_path, TrackerValidation(), ValidationParams(count=8, settle_s=0.2))
    assert not pose_notes(RunReader(first))
    assert {(row["u_x_mm"], row["u_deg"]) for row in pose_rows(RunReader(first))} == {(0.02, 0.03)}
    runner, result = CliRunner(), tmp_path / "arm.json"
    done = runner.invoke(cli, ["calibrate", str(first), "--model", "frames", "-o", str(result)])
    assert done.exit_code == 0, done.output
    done = runner.invoke(cli, ["validate", str(result), "--measured", str(second), "--json"])
    assert done.exit_code == 0, done.output
    found = json.loads(done.stdout)
    # The scripted arm is as it is drawn.
    assert found["n"] == 8
    assert found["calibrated"]["max_mm"] < 1e-6


@pytest.mark.parametrize("unstated", ["u_frame_mm", "u_frame_deg"])
async def test_half_stated_uncertainties_are_dropped_and_named(tmp_path: Path, unstated: str) -> None:
    params = CalibrationParams(count=14, candidates=300, model="geometric", settle_s=0.2)
    run = await cmm_run(tmp_path, TrackerCalibration(), params, **{unstated: None})
    assert not {name for row in pose_rows(RunReader(run)) for name in row if name.startswith(("u_", "cov_"))}
    (note,) = pose_notes(RunReader(run))
    assert "state u_mm, and u_deg" in note
    words = ["calibrate", str(run), "--model", "frames", "-o", str(tmp_path / "arm.json")]
    done = CliRunner().invoke(cli, words)
    assert done.exit_code == 0, done.output


async def test_a_summary_names_results_and_leaves_out_the_aim(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    procedure, result = BallbarTest(), {"format": "catseye-serial-arm/1", "parameters": []}
    meta = {"procedure": procedure.name, "params": {"result": result, "nests": []}, "aim": "cell file"}
    outcome = await carried_out(Room(tmp_path / "runs"), procedure, ballbar_plan(), meta=meta)
    shown = dict(summary(RunReader(outcome.path)))
    assert shown["parameters"] == "Result file: catseye-serial-arm/1"
    # Nothing aims a beam on this bench.
    assert "aim" not in shown


async def test_poses_of_a_run_and_of_a_table_stay_apart(tmp_path: Path) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    params = CalibrationParams(count=14, candidates=300, model="geometric", settle_s=0.2)
    first = await measured(Room(runs), tmp_path, TrackerCalibration(), params)
    # A table names its poses P0001 ... as the run does, and has measured others.
    table, result = tmp_path / "poses.csv", tmp_path / "arm.json"
    drawn = ValidationParams(count=8, settle_s=0.2, seed=7)
    other = await measured(Room(runs), tmp_path, TrackerValidation(), drawn)
    table.write_text(pose_export(RunReader(other)).csv, encoding="utf-8")
    words = ["--runs", str(runs), "--model", "frames", "-o", str(result)]
    done = CliRunner().invoke(cli, ["calibrate", first.name, "--poses", str(table), *words])
    assert done.exit_code == 0, done.output
    poses = json.loads(result.read_text(encoding="utf-8"))["errors"]["pose"]
    assert len(set(poses)) == 14 + 8
    assert "P0001" in poses
    assert f"{first.name}/P0001" in poses


async def test_a_measurement_given_twice_is_refused(tmp_path: Path) -> None:
    reader = RunReader(await validated(tmp_path))
    table = tmp_path / "poses.csv"
    table.write_text(pose_export(reader).csv, encoding="utf-8")
    words = ["--arm", "irb120", "--runs", str(tmp_path / "runs"), "-o", str(tmp_path / "arm.json")]
    for given in (
        [reader.path.name] * 2,
        ["--poses", str(table), "--poses", f"{tmp_path}/runs/../poses.csv"],
    ):
        done = CliRunner().invoke(cli, ["calibrate", *given, *words])
        assert isinstance(done.exception, UsageError)
        assert "is given twice" in str(done.exception)


def test_nothing_to_calibrate_with_is_refused(tmp_path: Path) -> None:
    done = CliRunner().invoke(cli, ["calibrate", "--arm", "irb120", "-o", str(tmp_path / "arm.json")])
    assert done.exit_code != 0


def test_right_angles_of_the_nests_are_meant() -> None:
    w1, w2, w3 = (np.array(NESTS[name]) for name in ("W1", "W2", "W3"))
    assert (w2 - w1) @ (w3 - w2) == 0.0
