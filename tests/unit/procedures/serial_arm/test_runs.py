"""Poses measured by a scripted tracker, with a real store."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.store.reader import RunReader
from catseye.app.store.verify import verify
from catseye.calibration.kinematics.rotations import rotation_of
from catseye.drivers.roles.errors import LinkError
from catseye.procedures.serial_arm.pose_plan import PosePlan
from catseye.procedures.serial_arm.tracker_calibration import CalibrationParams, TrackerCalibration
from catseye.procedures.serial_arm.tracker_validation import TrackerValidation, ValidationParams
from tests.unit.procedures.serial_arm.benches import (
    CMM,
    NESTS,
    SIX,
    STATION_MM,
    TRUE_SHIFT_MM,
    Room,
    carried_out,
)
from tests.unit.procedures.six_axes import CHAIN

SHORT = ValidationParams(count=6, nests_every=3, settle_s=0.2)


def plan_of(**changes: object) -> PosePlan:
    return TrackerValidation().plan(SIX, SHORT.model_copy(update=changes))


async def test_every_pose_is_measured_and_stored(tmp_path: Path) -> None:
    room, plan = Room(tmp_path), plan_of()
    outcome = await carried_out(room, TrackerValidation(), plan)
    assert (outcome.status, outcome.text) == ("complete", "")
    reader = RunReader(outcome.path)
    rows = reader.rows("targets")
    assert [row["pose"] for row in rows] == [one.name for one in plan.poses]
    for row, planned in zip(rows, plan.poses, strict=True):
        assert (row["q"], row["q_read"]) == (list(planned.pose), list(planned.pose))
        flange = CHAIN.flange(np.array([planned.pose]))[0]
        place = (flange @ [*SIX.target(planned.targets[0]).place_mm, 1.0])[:3] - STATION_MM + TRUE_SHIFT_MM
        assert [row["x_mm"], row["y_mm"], row["z_mm"]] == pytest.approx(place)
        assert [row["u_x_mm"], row["u_y_mm"], row["u_z_mm"]] == [0.02, 0.03, 0.04]
    assert [row["nests_round"] for row in rows] == [0, 0, 0, 1, 1, 1]
    assert [(row["nest"], row["nests_round"]) for row in reader.rows("nests")] == [
        (name, number) for number in range(3) for name in NESTS
    ]
    assert verify(outcome.path).problems == ()


async def test_the_target_is_looked_for_where_the_arm_holds_it(tmp_path: Path) -> None:
    room, plan = Room(tmp_path), plan_of()
    await carried_out(room, TrackerValidation(), plan)
    looked = [near for name, near in room.tracker.near if name not in NESTS]
    for near, planned in zip(looked, plan.poses, strict=True):
        flange = CHAIN.flange(np.array([planned.pose]))[0]
        place = (flange @ [*SIX.target(planned.targets[0]).place_mm, 1.0])[:3] - STATION_MM
        assert near == pytest.approx(place)


async def test_a_hidden_target_is_measured_at_the_end(tmp_path: Path) -> None:
    room, plan = Room(tmp_path), plan_of()
    target = plan.poses[0].targets[0]
    room.tracker.hidden = {target: 1}
    outcome = await carried_out(room, TrackerValidation(), plan)
    assert outcome.status == "complete"
    reader = RunReader(outcome.path)
    assert reader.result("pose/0000") == {"measured": [], "hidden": [target]}
    assert reader.result("again/0000") == {"measured": [target], "hidden": []}
    assert [row["pose"] for row in reader.rows("targets")][-1] == "P0001"
    assert len(reader.rows("targets")) == 6
    summary = reader.result("summary") or {}
    assert summary["left_out"] == 0


async def test_targets_hidden_everywhere_end_the_run(tmp_path: Path) -> None:
    room, plan = Room(tmp_path), plan_of()
    room.tracker.hidden = dict.fromkeys(("N1", "N2", "N3"), 1000)
    outcome = await carried_out(room, TrackerValidation(), plan)
    assert outcome.status == "failed"
    assert "6 of 6 poses stay without a target" in outcome.text
    assert "base_mm and base_deg" in outcome.text


async def test_a_moved_instrument_is_warned_of(tmp_path: Path) -> None:
    room, plan = Room(tmp_path), plan_of()
    room.tracker.drift_mm = {7: 0.4}
    outcome = await carried_out(room, TrackerValidation(), plan)
    assert outcome.status == "complete"
    warnings = [str(one["text"]) for one in room.said("warning")]
    assert sum("has moved by 0.400 mm" in text for text in warnings) == 2
    assert (RunReader(outcome.path).result("summary") or {})["nests_drift_mm"] == pytest.approx(0.4)


async def test_a_hidden_nest_is_left_out_with_a_warning(tmp_path: Path) -> None:
    room, plan = Room(tmp_path), plan_of()
    room.tracker.hidden = {"W2": 1}
    outcome = await carried_out(room, TrackerValidation(), plan)
    assert outcome.status == "complete"
    places = (RunReader(outcome.path).result("nests/00") or {})["places"]
    assert isinstance(places, dict)
    assert places["W2"] is None
    assert any("the nest W2 is hidden" in str(one["text"]) for one in room.said("warning"))


async def test_a_broken_link_ends_and_resume_goes_on(tmp_path: Path) -> None:
    room, plan = Room(tmp_path), plan_of()
    measure = room.tracker.point
    count = 0

    async def failing(*args: object, **kwargs: object) -> object:
        nonlocal count
        count += 1
        if count == 6:
            raise LinkError("the tracker does not answer")
        return await measure(*args, **kwargs)  # type: ignore[arg-type]  # passed on as they come

    room.tracker.point = failing  # type: ignore[method-assign,assignment]  # fails once
    first = await carried_out(room, TrackerValidation(), plan)
    assert first.status == "failed"
    again = Room(tmp_path)
    again.robot.pose = room.robot.pose
    outcome = await carried_out(again, TrackerValidation(), plan, resume=first.path)
    assert outcome.status == "complete"
    names = [row["pose"] for row in RunReader(outcome.path).rows("targets")]
    assert names == [one.name for one in plan.poses]
    # Two poses were stored, and the nests with them: the nests are measured before the rest, within and behind it.
    assert [name for name, _ in again.tracker.asked if name in NESTS] == [*NESTS, *NESTS, *NESTS]


async def test_each_interruption_has_nests_of_its_own(tmp_path: Path) -> None:
    plan = plan_of()
    path: Path | None = None
    for answers in (5, 3, 4, 99):
        room = Room(tmp_path)
        measure = room.tracker.point

        async def failing(
            *args: Any, answers: int = answers, room: Room = room, measure: Any = measure
        ) -> Any:
            if len(room.tracker.asked) == answers:
                raise LinkError("the tracker does not answer")
            return await measure(*args)

        room.tracker.point = failing  # type: ignore[method-assign,assignment]  # answers so many times
        resume: dict[str, object] = {} if path is None else {"resume": path}
        path = (await carried_out(room, TrackerValidation(), plan, **resume)).path
    assert path is not None
    reader = RunReader(path)
    # Interrupted behind two poses, behind the nests measured then, and one pose later, where nests follow anyway.
    assert [row["nests_round"] for row in reader.rows("targets")] == [0, 0, 2, 3, 3, 3]
    assert [step.step_id for step in reader.steps() if step.step_id.startswith("nests/")] == [
        "nests/00",
        "nests/resumed-pose-0002-1",
        "nests/resumed-pose-0002-2",
        "nests/03",
        "nests/04",
    ]


async def test_frames_are_found_by_turning_axes(tmp_path: Path) -> None:
    room = Room(tmp_path)
    plan = plan_of(frames=True, count=3)
    outcome = await carried_out(room, TrackerValidation(), plan)
    assert (outcome.status, outcome.text) == ("complete", "")
    row = RunReader(outcome.path).result("frames/base") or {}
    base = np.reshape(np.array(row["base"], dtype=np.float64), (4, 4))
    expected = np.eye(4)
    expected[:3, 3] = TRUE_SHIFT_MM - STATION_MM
    assert base == pytest.approx(expected, abs=1e-6)
    tool = RunReader(outcome.path).result("frames/tool") or {}
    assert tool["place_mm"] == pytest.approx(SIX.target(str(tool["target"])).place_mm, abs=1e-6)
    # From then on targets are looked for where they are.
    seen = [near for name, near in room.tracker.near if name not in NESTS][-1]
    flange = CHAIN.flange(np.array([plan.poses[-1].pose]))[0]
    place = (flange @ [*SIX.target(plan.poses[-1].targets[0]).place_mm, 1.0])[:3] + expected[:3, 3]
    assert seen == pytest.approx(place, abs=1e-6)


async def test_a_no_leaves_the_axes_alone(tmp_path: Path) -> None:
    room = Room(tmp_path)
    plan = plan_of(frames=True, count=3)
    room.answers = {f"turn/{plan.frames.base[0].name}-{plan.frames.base[1].name}": "no"}  # type: ignore[union-attr]  # asked for
    outcome = await carried_out(room, TrackerValidation(), plan)
    assert outcome.status == "failed"
    assert "frames=false" in outcome.text
    assert "move" not in room.robot.calls


@pytest.mark.parametrize("push_deg", [1.0, 0.06], ids=["hit", "brushed"])
async def test_an_arm_that_is_moved_is_measured_again(tmp_path: Path, push_deg: float) -> None:
    room, plan = Room(tmp_path), plan_of()
    measure = room.tracker.point
    pushed: list[object] = []

    async def pushing(*args: object, **kwargs: object) -> object:
        found = await measure(*args, **kwargs)  # type: ignore[arg-type]  # passed on as they come
        if args[0] not in NESTS and not pushed:
            pushed.append(args[0])
            room.robot.pose = tuple(value + push_deg for value in room.robot.pose)
        return found

    room.tracker.point = pushing  # type: ignore[method-assign,assignment]  # pushes once
    outcome = await carried_out(room, TrackerValidation(), plan)
    assert outcome.status == "complete"
    rows = RunReader(outcome.path).rows("targets")
    assert [row["pose"] for row in rows] == [one.name for one in plan.poses]
    assert any("somebody has moved it" in str(one["text"]) for one in room.said("warning"))


@pytest.mark.parametrize("off_deg", [0.08, 0.15])
async def test_a_read_back_beside_the_command_is_no_push(tmp_path: Path, off_deg: float) -> None:
    """Whether an arm has arrived is its driver's to say."""
    room, plan = Room(tmp_path), plan_of()
    room.robot.off = room.robot.read_back_limit = off_deg
    outcome = await carried_out(room, TrackerValidation(), plan)
    assert (outcome.status, outcome.text) == ("complete", "")
    for row, planned in zip(RunReader(outcome.path).rows("targets"), plan.poses, strict=True):
        assert row["q"] == list(planned.pose)
        assert row["q_read"] == pytest.approx([value + off_deg for value in planned.pose])


async def test_frames_of_an_optical_cmm_carry_their_orientation(tmp_path: Path) -> None:
    room = Room(tmp_path)
    plan = TrackerCalibration().plan(
        CMM, CalibrationParams(count=4, candidates=60, model="frames", settle_s=0.2, targets_per_pose=3)
    )
    outcome = await carried_out(room, TrackerCalibration(), plan)
    assert outcome.status == "complete"
    reader = RunReader(outcome.path)
    row = reader.rows("targets")[0]
    turn = np.array([row[name] for name in ("rx_deg", "ry_deg", "rz_deg")], dtype=np.float64)
    assert rotation_of(turn) == pytest.approx(CHAIN.flange(np.array([row["q"]]))[0, :3, :3], abs=1e-9)
    assert row["u_deg"] == 0.03
    assert row["visible"] == 30
    assert reader.rows("nests") == []


@pytest.mark.parametrize(
    ("marks", "base_marks", "status"),
    [(8, None, "failed"), (9, 12, "complete"), (30, 11, "failed"), (None, None, "complete")],
)
async def test_a_frame_with_too_few_marks_counts_as_hidden(
    tmp_path: Path, marks: int | None, base_marks: int | None, status: str
) -> None:
    """Section 5 of the paper: 9 of the tool, 12 of the base. An instrument that does not say is believed."""
    room = Room(tmp_path)
    room.tracker.marks, room.tracker.base_marks = marks, base_marks
    plan = TrackerCalibration().plan(
        CMM, CalibrationParams(count=4, candidates=60, model="frames", settle_s=0.2)
    )
    outcome = await carried_out(room, TrackerCalibration(), plan)
    assert outcome.status == status
    if status == "failed":
        assert "4 of 4 poses stay without a target" in outcome.text
    else:
        row = RunReader(outcome.path).rows("targets")[0]
        assert (row["visible"], row["base_visible"]) == (marks, base_marks)
