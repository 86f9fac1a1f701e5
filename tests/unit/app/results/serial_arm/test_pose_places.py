"""Poses of a run that are to come, measured or hidden."""

from pathlib import Path

import numpy as np
import pytest

from catseye.app.results.figures import Figure, Points
from catseye.app.results.serial_arm.pose_places import places_figure
from catseye.app.store.reader import RunReader
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams
from catseye.simulators.world.serial.screws import ScrewArm
from tests.unit.app.results.serial_arm.test_run_poses import measured
from tests.unit.procedures.serial_arm.benches import Room
from tests.unit.simulators.world.serial.arms import serial_arm

POSES = 6
PARAMS = ValidationParams(count=POSES, nests_every=3, settle_s=0.2)


async def run(folder: Path, **hidden: int) -> RunReader:
    runs = folder / "runs"
    runs.mkdir()
    room = Room(runs)
    room.tracker.hidden = hidden
    return RunReader(await measured(room, folder, TrackerValidation(), PARAMS))


def points(figure: Figure | None) -> list[Points]:
    assert figure is not None
    (panel, _) = figure.rows[0]
    assert panel is not None
    return [mark for mark in panel.marks if isinstance(mark, Points)]


def labels(figure: Figure | None) -> list[str]:
    return [one.label for one in points(figure)]


async def test_each_pose_is_to_come_until_it_is_measured(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    reader = await run(tmp_path)
    assert labels(places_figure(reader)) == [f"measured: {POSES}"]
    done = reader.steps()
    second = next(place for place, step in enumerate(done) if step.step_id == "pose/0001")
    monkeypatch.setattr(RunReader, "steps", lambda _self: done[: second + 1])
    assert labels(places_figure(reader)) == ["to come: 4", "measured: 2"]


async def test_a_pose_without_a_target_is_hidden(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    reader = await run(tmp_path, N1=1)
    # It is hidden after its first visit, and seen at the end.
    assert labels(places_figure(reader)) == [f"measured: {POSES}"]
    before = [step for step in reader.steps() if not step.step_id.startswith("again/")]
    monkeypatch.setattr(RunReader, "steps", lambda _self: before)
    assert labels(places_figure(reader)) == [f"measured: {POSES - 1}", "hidden: 1"]


async def test_a_pose_lies_where_screws_have_the_flange(tmp_path: Path) -> None:
    reader = await run(tmp_path)
    (shown,) = points(places_figure(reader))
    poses = np.array(reader.data_of("poses-planned")[-1]["poses"])
    flange = ScrewArm(serial_arm("irb120").joints).last_frame(poses)[:, :3, 3]
    assert np.column_stack([shown.x, shown.y]) == pytest.approx(flange[:, :2], abs=1e-6)
