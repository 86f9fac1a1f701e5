"""Axis analysis, check of the instrument and warm-up on a scripted tracker."""

import math
from pathlib import Path

import numpy as np
import pytest

from catseye.app.engine.dry_run import DryRunContext
from catseye.app.store.reader import RunReader
from catseye.procedures.kit.errors import HiddenTargetsError, PlanError
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Json
from catseye.procedures.kit.system import System
from catseye.procedures.serial_arm.axis_analysis import AxisAnalysis, AxisParams
from catseye.procedures.serial_arm.instrument_check import CheckParams, InstrumentCheck
from catseye.procedures.serial_arm.tracker_warmup import TrackerWarmup, WarmupParams, Watch
from tests.unit.procedures.serial_arm.benches import SIX, TARGETS, Room, carried_out

AXES = AxisParams(joints=["A1", "A5"], settle_s=0.2, reach_deg=60.0)
CHECK = CheckParams(repeats=3, bar_mm=1000.0, bar_places=2, settle_s=0.2)
WARM = WarmupParams(
    window_min=2.0, exercise_poses=2, cycles=1, checks=2, settle_s=0.2, duration_limit_min=30.0
)


@pytest.mark.parametrize(
    ("procedure", "params"), [(AxisAnalysis(), AXES), (InstrumentCheck(), CHECK), (TrackerWarmup(), WARM)]
)
async def test_a_rehearsal_comes_to_its_end(procedure: Procedure, params: object) -> None:
    plan = procedure.plan(SIX, params)
    dry = DryRunContext(System(SIX), pose=(0.0,) * 6, declared=procedure.records)
    await procedure.run(dry, plan)
    dry.require_clear_ways()
    assert dry.total_s > 0.0


async def test_a_perfect_joint_shows_no_errors(tmp_path: Path) -> None:
    room = Room(tmp_path)
    outcome = await carried_out(room, AxisAnalysis(), AxisAnalysis().plan(SIX, AXES))
    assert (outcome.status, outcome.text) == ("complete", "")
    reader = RunReader(outcome.path)
    for name in ("A1", "A5"):
        row = reader.result(f"axis/{name}") or {}
        assert float(str(row["tangential_range_mm"])) < 1e-6
        assert float(str(row["backlash_deg"])) == pytest.approx(0.0, abs=1e-9)
        assert float(str(row["high_deg"])) - float(str(row["low_deg"])) >= 30.0


async def test_play_of_a_joint_is_its_backlash(tmp_path: Path) -> None:
    room = Room(tmp_path)
    move = room.robot.move_joints
    came_from = [0.0]

    async def with_play(target: tuple[float, ...]) -> None:
        # The first joint stays behind by 0.01° on whichever side it comes from.
        side = math.copysign(0.01, target[0] - came_from[0]) if target[0] != came_from[0] else 0.0
        came_from[0] = target[0]
        await move((target[0] - side, *target[1:]))

    room.robot.move_joints = with_play  # type: ignore[method-assign]  # a joint with play
    plan = AxisAnalysis().plan(SIX, AXES.model_copy(update={"joints": ["A1"]}))
    outcome = await carried_out(room, AxisAnalysis(), plan)
    assert outcome.status == "complete"
    row = RunReader(outcome.path).result("axis/A1") or {}
    assert row["backlash_deg"] == pytest.approx(-0.02, abs=1e-6)
    assert row["angular_range_deg"] == pytest.approx(0.02, abs=1e-6)


async def test_hidden_places_are_left_out_of_the_circle(tmp_path: Path) -> None:
    room = Room(tmp_path)
    plan = AxisAnalysis().plan(SIX, AXES.model_copy(update={"joints": ["A1"]}))
    room.tracker.hidden = {plan.turns[0].target: 2}
    outcome = await carried_out(room, AxisAnalysis(), plan)
    assert outcome.status == "complete"
    row = RunReader(outcome.path).result("axis/A1") or {}
    assert row["hidden"] == list(plan.turns[0].values_deg[:2])
    assert len(RunReader(outcome.path).rows("targets")) == len(plan.turns[0].order) - 2


def test_a_joint_that_slides_or_is_unknown_is_refused() -> None:
    with pytest.raises(PlanError, match="A9 is not an axis that turns"):
        AxisAnalysis().plan(SIX, AXES.model_copy(update={"joints": ["A9"]}))


async def test_a_tool_out_of_sight_is_said_to_be_unchecked(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.tracker.hidden = {target.name: 100 for target in TARGETS[1:]}
    check = CheckParams(repeats=2, settle_s=0.2)
    await carried_out(room, InstrumentCheck(), InstrumentCheck().plan(SIX, check))
    (said,) = [str(one["text"]) for one in room.said("warning") if "on the tool" in str(one["text"])]
    assert said == (
        f"no distance on the tool is checked, because only {TARGETS[0].name} of its targets is visible: jog "
        "the arm to where several face the instrument, and check again"
    )


async def test_the_check_compares_faces_bar_and_tool(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.tracker.face_mm = 0.02
    bar = {"bar1": np.array([0.0, 0.0, 0.0]), "bar2": np.array([600.0, 800.03, 0.0])}
    on_tool = room.tracker._on_tool  # noqa: SLF001  # the bar has no place of its own on this bench
    room.tracker._on_tool = lambda name: bar[name] if name in bar else on_tool(name)  # type: ignore[method-assign,assignment]  # noqa: SLF001  # as above
    outcome = await carried_out(room, InstrumentCheck(), InstrumentCheck().plan(SIX, CHECK))
    assert (outcome.status, outcome.text) == ("complete", "")
    reader = RunReader(outcome.path)
    row = reader.result("nest/W1") or {}
    assert row["two_face_mm"] == pytest.approx(0.04)
    assert row["repeatability_mm"] == pytest.approx(0.0, abs=1e-12)
    bars = [one for one in reader.rows("lengths") if one["what"] == "scale bar"]
    assert [one["error_mm"] for one in bars] == pytest.approx([math.hypot(600.0, 800.03) - 1000.0] * 2)
    tool = [one for one in reader.rows("lengths") if one["what"] == "tool"]
    assert [one["reference_mm"] for one in tool] == pytest.approx(
        [math.dist(TARGETS[i].place_mm, TARGETS[k].place_mm) for i, k in ((0, 1), (0, 2), (1, 2))]
    )
    assert [one["error_mm"] for one in tool] == pytest.approx([0.0] * 3, abs=1e-9)
    assert "move" not in room.robot.calls


@pytest.mark.usefixtures("written_at_once")
async def test_an_arm_that_stands_still_is_warm(tmp_path: Path) -> None:
    outcome = await carried_out(Room(tmp_path), TrackerWarmup(), TrackerWarmup().plan(SIX, WARM))
    assert (outcome.status, outcome.text) == ("complete", "")
    verdict = RunReader(outcome.path).result("verdict") or {}
    assert verdict["warm"] is True
    assert verdict["drift_um_per_10min"] == pytest.approx(0.0, abs=1e-6)
    # A full window and two visits in a row.
    assert 2.0 <= float(str(verdict["elapsed_min"])) <= 5.0


def watched(rate_um_per_10min: float, visits: int, every_s: float = 30.0) -> Watch:
    watch = Watch(TrackerWarmup().plan(SIX, WARM))
    for number in range(visits):
        moved = rate_um_per_10min * 1e-3 * number * every_s / 600.0
        watch.take({"clock_s": number * every_s, "place_mm": [1.0, 2.0 + moved, 3.0]})
    return watch


def test_a_drift_beyond_the_limit_is_not_warm() -> None:
    assert watched(40.0, 12).drift == pytest.approx(40.0)
    assert not watched(40.0, 12).warm
    assert watched(20.0, 12).warm


def test_a_long_wait_begins_the_watch_anew() -> None:
    watch = watched(20.0, 12)
    waited_s = 3.1 * watch.plan.visit_s
    watch.take({"clock_s": 360.0 + waited_s, "waited_s": waited_s, "place_mm": [1.0, 2.0, 3.0]})
    assert not watch.warm
    assert watch.drift is None


def test_slow_visits_are_no_rests() -> None:
    watch = watched(20.0, 12, every_s=4.0 * 60.0 * WARM.window_min)
    assert watch.drift == pytest.approx(20.0)
    assert watch.warm


@pytest.mark.parametrize("place_mm", [[1.0, 2.0, 3.0], None])
def test_another_process_begins_the_watch_anew(place_mm: Json) -> None:
    watch = watched(20.0, 12)
    watch.take({"clock_s": 370.0, "begins": True, "place_mm": place_mm})
    assert not watch.warm
    assert watch.drift is None


@pytest.mark.usefixtures("written_at_once")
async def test_the_first_visit_of_a_process_says_so(tmp_path: Path) -> None:
    outcome = await carried_out(Room(tmp_path), TrackerWarmup(), TrackerWarmup().plan(SIX, WARM))
    visits = [step.result for step in RunReader(outcome.path).steps() if step.step_id.startswith("visit/")]
    assert [row["begins"] for row in visits] == [True, *[False] * (len(visits) - 1)]


def test_a_target_that_stays_hidden_ends_the_warmup() -> None:
    watch = watched(20.0, 3)
    for number in range(4):
        watch.take({"clock_s": 100.0 + number, "place_mm": None})
    with pytest.raises(HiddenTargetsError, match="5 visits in a row"):
        watch.take({"clock_s": 104.0, "place_mm": None})
