"""Poses that were visited again, and poses of several runs: each approach is one of its own."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from catseye.app.cell.arm import arm_description
from catseye.app.results.serial_arm.measured_poses import MeasuredPoses, read_measured_poses
from catseye.app.results.serial_arm.nominal_arm import serial_arm_of
from catseye.app.results.serial_arm.run_poses import as_tables, pose_rows, visit_names
from catseye.app.store.reader import RunReader
from catseye.calibration.serial_arm.left_out_poses import same_command
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams
from tests.unit.app.results.serial_arm import test_run_poses
from tests.unit.app.results.serial_arm.test_run_poses import measured
from tests.unit.procedures.serial_arm.benches import SIX, Room


@pytest.fixture(autouse=True)
def targets_seen_from_everywhere(monkeypatch: pytest.MonkeyPatch) -> None:
    targets = tuple(replace(one, normal=None) for one in SIX.targets)
    monkeypatch.setattr(test_run_poses, "SIX", replace(SIX, targets=targets))


async def run(folder: Path, hidden: Sequence[str] = ()) -> RunReader:
    (folder / "runs").mkdir(parents=True)
    room = Room(folder / "runs")
    room.tracker.hidden = dict.fromkeys(hidden, 1)
    params = ValidationParams(count=8, nests_every=4, settle_s=0.2, targets_per_pose=2)
    return RunReader(await measured(room, folder, TrackerValidation(), params))


def read(*readers: RunReader) -> MeasuredPoses:
    description = arm_description("irb120")
    with as_tables(readers) as tables:
        return read_measured_poses(tables, description, serial_arm_of(description, None), {})


async def test_a_pose_visited_again_has_its_own_name(tmp_path: Path) -> None:
    reader = await run(tmp_path, ["N2"])
    stored, rows = reader.rows("targets"), pose_rows(reader)
    again = [str(row["step_id"]).startswith("again/") for row in stored]
    assert any(again)
    assert [row["pose"] for row in rows] == [
        f"{row['pose']}/2" if twice else row["pose"] for row, twice in zip(stored, again, strict=True)
    ]


async def test_both_visits_of_a_pose_are_left_out_together(tmp_path: Path) -> None:
    rows = read(await run(tmp_path, ["N2"])).measurements
    command = dict(zip(rows.names, same_command(rows).tolist(), strict=True))
    both = [name for name in command if f"{name}/2" in command]
    assert both
    assert all(command[name] == command[f"{name}/2"] for name in both)
    assert all(rows.names.index(name) != rows.names.index(f"{name}/2") for name in both)


async def test_poses_of_several_runs_stay_apart(tmp_path: Path) -> None:
    one, other = await run(tmp_path / "a"), await run(tmp_path / "b")
    rows = read(one, other).measurements
    assert len(set(rows.names)) == len(read(one).measurements.names) + len(read(other).measurements.names)
    assert np.unique(rows.poses).size == len(rows.names)
    assert {name.rpartition("/")[0] for name in rows.names} == {one.path.name, other.path.name}


def test_a_second_visit_takes_a_name_that_no_pose_has() -> None:
    # As in the export of a run whose hidden pose was visited again, given back to be driven.
    visits = [("pose/1", "P1"), ("pose/2", "P1/2"), ("again/1", "P1"), ("again/2", "P1/2")]
    stored = [{"step_id": step, "pose": pose} for step, pose in visits]
    assert visit_names(stored) == ["P1", "P1/2", "P1/3", "P1/2/2"]
