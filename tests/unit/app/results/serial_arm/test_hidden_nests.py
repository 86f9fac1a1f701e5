"""The world frame of a run some of whose nests were hidden."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from typer.testing import CliRunner

from catseye.app.cli import cli
from catseye.app.results.serial_arm.result import read_serial_arm
from catseye.app.results.serial_arm.run_poses import pose_export, pose_notes, pose_rows, world_covariance
from catseye.app.store.reader import RunReader
from catseye.drivers.roles.tracker import Place
from catseye.procedures.kit.stored import number_of
from catseye.procedures.serial_arm.bench import FixedNest, SerialBench
from catseye.procedures.serial_arm.tracker_calibration import CalibrationParams, TrackerCalibration
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams
from tests.unit.app.results.serial_arm import test_run_poses
from tests.unit.app.results.serial_arm.test_run_poses import in_world, measured, place_of
from tests.unit.procedures.serial_arm.benches import NESTS, SIX, Room

PARAMS = ValidationParams(count=8, nests_every=4, settle_s=0.2)


@pytest.fixture(autouse=True)
def cell_with_nests(monkeypatch: pytest.MonkeyPatch) -> None:
    plain = test_run_poses.configuration

    def configuration(folder: Path) -> Any:
        nests = [
            {"name": name, **dict(zip(("x_mm", "y_mm", "z_mm"), place, strict=True))}
            for name, place in NESTS.items()
        ]
        tracker = {"driver": "leica-emscon", "endpoint": "tcp://127.0.0.1:700", "nest": nests}
        return {**plain(folder), "tracker": tracker}

    monkeypatch.setattr(test_run_poses, "configuration", configuration)


async def run(
    tmp_path: Path,
    hidden: Mapping[str, int],
    bench: SerialBench = SIX,
    covariance_mm2: Place | None = (0.0, 0.0, 0.0),
) -> RunReader:
    runs = tmp_path / "runs"
    runs.mkdir(exist_ok=True)
    room = Room(runs)
    room.tracker.hidden, room.tracker.covariance_mm2 = dict(hidden), covariance_mm2
    return RunReader(await measured(room, tmp_path, TrackerValidation(), PARAMS, bench))


@pytest.mark.parametrize("name", ["W1", "W2", "W3"])
async def test_a_nest_hidden_once_changes_no_frame(tmp_path: Path, name: str) -> None:
    reader = await run(tmp_path, {name: 1})
    for row, stored in zip(pose_rows(reader), reader.rows("targets"), strict=True):
        assert place_of(row) == pytest.approx(in_world(place_of(stored)), abs=1e-9)
    assert not pose_notes(reader)


async def test_a_nest_never_seen_is_reported(tmp_path: Path) -> None:
    reader = await run(tmp_path, {"W2": 99})
    assert "no world frame: of the fixed nests W2 was hidden in every measurement" in pose_notes(reader)[0]
    for row, stored in zip(pose_rows(reader), reader.rows("targets"), strict=True):
        assert np.array_equal(place_of(row), place_of(stored))


async def test_a_round_that_saw_no_nest_takes_the_nearest(tmp_path: Path) -> None:
    reader = await run(tmp_path, {"W1": 1, "W2": 1, "W3": 1})
    stored = reader.rows("targets")
    assert {row["nests_round"] for row in stored} == {0, 1}
    assert {row["nests_round"] for row in reader.rows("nests")} == {1, 2}
    for row, one in zip(pose_rows(reader), stored, strict=True):
        assert place_of(row) == pytest.approx(in_world(place_of(one)), abs=1e-9)
    assert (
        "measurement 0 of the nests saw none of them: places after it stand in the world frame by measurement 1"
        in pose_notes(reader)[0]
    )


async def test_nests_that_no_round_saw_are_reported(tmp_path: Path) -> None:
    reader = await run(tmp_path, dict.fromkeys(NESTS, 99))
    assert "of the fixed nests W1, W2, W3 was hidden in every measurement" in pose_notes(reader)[0]


async def test_nests_left_on_a_line_make_no_frame(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Beside the line of the first two, W3 alone makes a frame; the tracker cannot see it.
    w1, w2 = np.array(NESTS["W1"]), np.array(NESTS["W2"])
    x, y, z = (w1 + 2.0 * (w2 - w1)).tolist()
    monkeypatch.setitem(NESTS, "W4", (x, y, z))
    nests = tuple(FixedNest(name, place) for name, place in NESTS.items())
    bench = replace(SIX, instrument=replace(SIX.instrument, nests=nests))
    reader = await run(tmp_path, {"W3": 99}, bench)
    (note,) = pose_notes(reader)
    assert "W3 was hidden in every measurement, and W1, W2, W4 lie on a line" in note
    for row, stored in zip(pose_rows(reader), reader.rows("targets"), strict=True):
        assert np.array_equal(place_of(row), place_of(stored))


async def test_frame_is_as_uncertain_as_the_mean_of_its_nests(tmp_path: Path) -> None:
    reader = await run(tmp_path, {"W1": 1}, covariance_mm2=(1e-4, -2e-4, 3e-4))
    seen = [row for row in reader.rows("nests") if row["nest"] == "W1"]
    covariance = world_covariance(reader)
    assert covariance is not None
    # The origin is on the first nest; turned axes leave the sum of its variances as it is.
    assert len(seen) == 2
    assert [seen[0][f"cov_{axes}_mm2"] for axes in ("xy", "xz", "yz")] == [1e-4, -2e-4, 3e-4]
    square = sum(number_of(seen[0], f"u_{axis}_mm") ** 2 for axis in "xyz")
    assert np.trace(covariance[:3, :3]) == pytest.approx(square / 2.0, rel=1e-6)


async def test_base_of_a_run_knows_the_noise_of_its_nests(tmp_path: Path) -> None:
    table, runs = tmp_path / "poses.csv", tmp_path / "runs"
    runs.mkdir()
    params = CalibrationParams(count=14, candidates=300, model="geometric", settle_s=0.2)
    reader = RunReader(await measured(Room(runs), tmp_path, TrackerCalibration(), params))
    table.write_text(pose_export(reader).csv, "utf-8")
    u_mm = []
    for source in ([reader.path.name, "--runs", str(runs)], ["--poses", str(table), "--arm", "irb120"]):
        words = ["calibrate", *source, "--model", "frames", "-o", str(tmp_path / "arm.json")]
        done = CliRunner().invoke(cli, words)
        assert done.exit_code == 0, done.output
        parts = {one.name: one.u for one in read_serial_arm(tmp_path / "arm.json").parameters}
        u_mm.append(parts["base.x_mm"])
    # The first nest alone, of the mean of all rounds, moves the base by that.
    rounds = {row["nests_round"] for row in reader.rows("nests")}
    assert u_mm[0] ** 2 - u_mm[1] ** 2 > 0.02**2 / len(rounds)
