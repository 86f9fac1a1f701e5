"""What a procedure is given, on scripted instruments and a real store."""

import asyncio
import math
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest

from catseye.app.engine.gate import MotionGate, require_in_range
from catseye.app.engine.operator import Answer, Operator
from catseye.app.errors import (
    ConfigError,
    InterruptedRunError,
    LimitError,
    LinkFailedError,
    PromptUnansweredError,
    SafetyError,
)
from catseye.app.protocol.state import ControlState
from catseye.drivers.roles.interferometer import BeamStatus
from catseye.drivers.roles.pose import Pose
from catseye.drivers.roles.robot import RobotAbilities, RobotStatus
from catseye.procedures.kit.columns import Columns
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.errors import TableFileError
from catseye.procedures.kit.live import Live
from catseye.procedures.kit.records import Row
from catseye.procedures.kit.tasks import ClearBeam, TurnScrew
from catseye.procedures.scara.path.instrument_file import mapping_of
from catseye.procedures.scara.path.tables import MEASURED
from catseye.procedures.scara.records import SeenReflector
from tests.unit.app.engine.fakes import ARM, AWAY, HOME, FakeRobot, distance, free_way
from tests.unit.app.engine.given_parts import READY, Parts
from tests.unit.procedures.benches import scara_axes


async def nothing() -> Row:
    return {}


async def test_rows_are_committed_with_their_step_before_being_published(parts: Parts) -> None:
    async def action() -> Row:
        parts.ctx.record(distance(1))
        parts.ctx.record(distance(2))
        assert parts.reader.rows("points") == []
        return {"answer": 42}

    assert await parts.ctx.step("s1", "first", action) == {"answer": 42}
    assert [row["theta1_deg"] for row in parts.reader.rows("points")] == [1.0, 2.0]
    assert parts.reader.steps()[0].row_count == 2
    assert [entry["event"] for entry in parts.bench.published] == [
        "step-started",
        "point",
        "point",
        "step-done",
    ]


async def test_a_motion_question_states_target_override_and_speed(parts: Parts) -> None:
    target = (10.0, -20.0, 0.0, 30.0)
    await parts.ctx.ask(Prompt("place/P1", "confirm", "Put it there.", motion=True, target=target))
    question = parts.bench.published[0]
    assert question["target"] == [10.0, -20.0, 0.0, 30.0]
    assert question["override_percent"] == 20.0
    # The fastest joints of the arm, 420, 720 and 3000 deg/s, at a fifth of their speed.
    assert question["speed_deg_s"] == [84.0, 144.0, 600.0]


@pytest.mark.parametrize(
    ("rests_after", "stated"), [(None, ["stop"]), ((), []), (("stop", "skip"), ["stop", "skip"])]
)
async def test_a_motion_question_states_which_choices_leave_the_arm_resting(
    parts: Parts, rests_after: tuple[str, ...] | None, stated: list[str]
) -> None:
    choices = ("retry", "skip", "stop")
    await parts.ctx.ask(
        Prompt("b", "choice", "?", choices, safe_answer="stop", motion=True, rests_after=rests_after)
    )
    assert parts.bench.published[0]["rests_after"] == stated


async def test_a_question_without_a_motion_states_no_target(parts: Parts) -> None:
    await parts.ctx.ask(Prompt("sense", "choice", "Which?", choices=("a", "b"), safe_answer="b"))
    question = parts.bench.published[0]
    assert question["safe_answer"] == "b"
    assert "target" not in question


async def test_a_done_step_returns_its_stored_result_without_running(parts: Parts) -> None:
    runs = 0

    async def action() -> Row:
        nonlocal runs
        runs += 1
        return {"runs": runs}

    await parts.ctx.step("s1", "first", action)
    assert await parts.ctx.step("s1", "first", action) == {"runs": 1}
    assert runs == 1
    assert parts.bench.published[-1]["stored"] is True


async def test_an_exception_drops_the_rows_and_stores_that(parts: Parts) -> None:
    async def fails() -> Row:
        parts.ctx.record(distance())
        raise ValueError("bad luck")

    with pytest.raises(ValueError, match="bad luck"):
        await parts.ctx.step("s1", "first", fails)
    await parts.ctx.step("s1", "first", nothing)
    (dropped,) = [event for event in parts.reader.events() if event.kind == "step-dropped"]
    assert dropped.data == {"step_id": "s1", "attempt": 1, "error": "ValueError: bad luck", "rows": 1}
    assert parts.reader.rows("points") == []
    assert parts.reader.steps()[0].attempt == 2


async def test_a_row_outside_of_a_step_is_refused(parts: Parts) -> None:
    with pytest.raises(RuntimeError, match="outside of a step"):
        parts.ctx.record(distance())


async def test_an_incomplete_row_is_refused_when_recorded(parts: Parts) -> None:
    async def action() -> Row:
        parts.ctx.record(distance(signal=math.nan))
        return {}

    with pytest.raises(ValueError, match=r"points\.signal = nan"):
        await parts.ctx.step("s1", "first", action)


@pytest.mark.parametrize(
    ("result", "text"),
    [
        (None, "step s1 returned None, a NoneType: it has to return a dict"),
        ({"seen": {"P1"}}, r"the result of step s1 cannot be kept: seen = \{'P1'\} is a set"),
    ],
)
async def test_a_result_that_could_not_be_read_back_is_refused(parts: Parts, result: Any, text: str) -> None:
    async def action() -> Row:
        returned: Row = result
        return returned

    with pytest.raises(ValueError, match=text):
        await parts.ctx.step("s1", "first", action)
    assert parts.reader.steps() == []


async def test_a_wrong_record_is_named_with_its_type(parts: Parts) -> None:
    async def action() -> Row:
        parts.ctx.record(distance(extra={"seen": {"P1"}}))
        return {}

    with pytest.raises(ValueError, match="a Distance cannot be kept: points: seen = "):
        await parts.ctx.step("s1", "first", action)


async def test_what_is_no_record_is_refused(parts: Parts) -> None:
    async def action() -> Row:
        row: Any = {"signal": 1.0}
        parts.ctx.record(row)
        return {}

    with pytest.raises(RuntimeError, match=r"\{'signal': 1.0\} is a dict: only a Record"):
        await parts.ctx.step("s1", "first", action)


async def test_a_record_that_is_not_declared_is_refused(parts: Parts) -> None:
    async def action() -> Row:
        parts.ctx.record(SeenReflector(reflector="P1", theta1_deg=1.0, theta2_deg=2.0))
        return {}

    with pytest.raises(RuntimeError, match="records a SeenReflector, which it does not declare"):
        await parts.ctx.step("s1", "first", action)


async def test_steps_do_not_nest(parts: Parts) -> None:
    async def outer() -> Row:
        return await parts.ctx.step("inner", "inner", nothing)

    with pytest.raises(RuntimeError, match="do not nest"):
        await parts.ctx.step("outer", "outer", outer)


@pytest.mark.parametrize(
    ("target", "text"),
    [
        ((171.0, 0.0, 0.0, 0.0), "J1 = 171 deg is outside -170 … 170 deg"),
        ((0.0, -146.0, 0.0, 0.0), "J2 = -146"),
        ((0.0, 0.0, 0.0, 361.0), "J4 = 361"),
        ((float("nan"), 0.0, 0.0, 0.0), "J1 = nan"),
        ((0.0, 0.0, float("inf"), 0.0), "J3 = inf"),
    ],
)
async def test_limits_hold_at_the_gate(parts: Parts, target: Pose, text: str) -> None:
    with pytest.raises(LimitError, match=text):
        await parts.ctx.move(target)
    assert "move" not in parts.bench.robot.calls


def test_prismatic_axes_are_checked_in_millimetres() -> None:
    with pytest.raises(LimitError, match="J3 = 1 mm is outside -10 … 0 mm"):
        require_in_range(scara_axes(j3_mm=(-10.0, 0.0)), (0.0, 0.0, 1.0, 0.0))


@pytest.mark.parametrize(
    ("state", "text"),
    [
        (replace(READY, emergency_stop=True), "emergency stop"),
        (replace(READY, alarm_number=2500, alarm_text="tracking: look"), "alarm 2500: tracking"),
        (replace(READY, teach_mode=True), "TEACH"),
        (replace(READY, machine_locked=True), "machine lock is on"),
        (replace(READY, servo_on=False), "drives are off"),
    ],
)
async def test_the_controllers_state_is_looked_at_before_each_move(
    parts: Parts, state: RobotStatus, text: str
) -> None:
    await parts.ctx.move(AWAY)
    parts.bench.robot.state = state
    with pytest.raises(SafetyError, match=text):
        await parts.ctx.move(AWAY)
    assert parts.bench.robot.calls.count("move") == 1


async def test_a_raised_override_is_acknowledged_and_lowered(parts: Parts) -> None:
    await parts.ctx.move(AWAY)
    robot = parts.bench.robot
    robot.state = replace(READY, override_percent=21.0)
    await parts.ctx.move(HOME)
    assert robot.calls[-4:] == ["move", "stop", "override 20", "move"]
    assert [said["id"] for said in parts.bench.said("prompt")] == ["acknowledge/1"]


async def test_an_override_that_stays_up_is_never_driven_with(parts: Parts) -> None:
    robot = parts.bench.robot
    robot.state = replace(READY, override_percent=float("nan"))
    with pytest.raises(SafetyError, match="reads nan %"):
        await parts.ctx.move(HOME)
    assert "move" not in robot.calls


class WayFakeRobot(FakeRobot):
    """Passes the targets of a way in one motion."""

    abilities: ClassVar[RobotAbilities] = RobotAbilities(following="blended")

    async def follow(self, way: Sequence[Pose]) -> None:
        self.calls.append(f"follow {len(way)}")
        self.pose = way[-1]


async def test_a_path_is_one_motion_if_the_robot_supports_it(parts: Parts) -> None:
    robot = WayFakeRobot(parts.bench.clock, state=READY)
    parts.control.attach(robot)
    gate = MotionGate(robot, ARM.axes, free_way, 20.0)
    parts.ctx._gate = gate  # noqa: SLF001  # the fixture's own context, with another robot
    parts.ctx._mover._robot, parts.ctx._mover._gate = robot, gate  # noqa: SLF001  # as above
    parts.ctx._devices = replace(parts.ctx._devices, robot=robot)  # noqa: SLF001  # as above
    await parts.ctx.follow((HOME, AWAY, HOME))
    assert robot.calls == ["follow 3"]
    with pytest.raises(LimitError, match="J1 = 171"):
        await parts.ctx.follow((HOME, (171.0, 0.0, 0.0, 0.0), HOME))
    robot.state = replace(READY, alarm_number=2500)
    with pytest.raises(SafetyError, match="alarm 2500"):
        await parts.ctx.follow((HOME, AWAY))
    assert robot.calls == ["follow 3"]


async def test_a_path_otherwise_becomes_one_motion_per_target(parts: Parts) -> None:
    await parts.ctx.follow((AWAY, HOME, AWAY))
    assert parts.bench.robot.calls.count("move") == 3
    assert parts.bench.robot.pose == AWAY


async def test_a_cell_without_a_tracker_says_so(parts: Parts) -> None:
    with pytest.raises(ConfigError, match="tracker"):
        await parts.ctx.locate(0.5, (0.0, 0.0))
    with pytest.raises(ConfigError, match="tracker"):
        await parts.ctx.measure_target("N1", 0.5, 4.0)


async def test_how_the_instrument_is_mounted_is_stored_and_passed_on(parts: Parts) -> None:
    seen: list[float] = []
    parts.ctx.on_remounted = seen.append
    await parts.ctx.remounted(179.25)
    assert seen == [179.25]
    assert [event.data for event in parts.reader.events() if event.kind == "mounted"] == [
        {"turned_deg": 179.25}
    ]


async def test_a_pause_takes_the_time_of_the_bench(parts: Parts) -> None:
    start_s = parts.bench.clock.monotonic_s()
    await parts.ctx.pause(0.5)
    assert parts.bench.clock.monotonic_s() - start_s == pytest.approx(0.5)


async def test_a_stop_ends_a_pause(parts: Parts) -> None:
    pausing = asyncio.create_task(parts.ctx.pause(1000.0))
    for _ in range(10):
        await asyncio.sleep(0)
    assert not pausing.done()
    parts.control.stop("stopped in the test")
    with pytest.raises(InterruptedRunError, match="stopped in the test"):
        await pausing


async def test_a_measured_file_is_read_or_refused_with_its_name(parts: Parts, tmp_path: Path) -> None:
    path = tmp_path / "tracker.csv"
    path.write_text("x_mm,y_mm,x_meas_mm,y_meas_mm\n200,-500,1200.5,-500.25\n", encoding="utf-8")
    nothing = Columns({}, np.arange(0))
    found = await parts.ctx.read_table(f" {path} ", MEASURED, nothing)
    assert found.lines.tolist() == [2]
    assert found.stacked(("x_meas_mm", "y_meas_mm")).tolist() == [[1200.5, -500.25]]
    path.write_text("x_mm,y_mm,x_meas_mm,y_meas_mm\n200,-500,nan,-500.25\n", encoding="utf-8")
    with pytest.raises(TableFileError, match=r"tracker\.csv:2: x_meas_mm = 'nan'"):
        await parts.ctx.read_table(str(path), MEASURED, nothing)
    with pytest.raises(TableFileError, match="there is no such file"):
        await parts.ctx.read_table("elsewhere.csv", MEASURED, nothing)
    with pytest.raises(TableFileError, match="type the whole path"):
        await parts.ctx.read_table("~nobody-of-that-name/tracker.csv", MEASURED, nothing)


async def test_a_mapped_file_is_read_in_mm(parts: Parts, tmp_path: Path) -> None:
    path = tmp_path / "tracker.txt"
    path.write_text("P1  1.2005 -0.50025 0.3\nP2  1.2005 -0.49025 0.3\n", encoding="utf-8")
    columns = {
        "x_meas_mm": {"column": 2, "unit": "m"},
        "y_meas_mm": {"column": 3, "unit": "m", "sign": -1},
    }
    mapping = mapping_of({"separator": "blank", "decimal": ".", "header_lines": 0, "columns": columns})
    found = await parts.ctx.read_table(str(path), mapping, Columns({}, np.arange(0)))
    assert found.stacked(("x_meas_mm", "y_meas_mm")).tolist() == [[1200.5, 500.25], [1200.5, 490.25]]
    path.write_text("P1  1.2005\n", encoding="utf-8")
    with pytest.raises(TableFileError, match=r"tracker\.txt:1: 2 columns, but column 3 is wanted"):
        await parts.ctx.read_table(str(path), mapping, Columns({}, np.arange(0)))


async def test_question_and_answer_are_stored_and_published(parts: Parts) -> None:
    answer = await parts.ctx.ask(Prompt("clear", "confirm", "Confirm that the cell is clear."))
    assert answer == "yes"
    (stored,) = parts.reader.prompts()
    assert (stored["id"], stored["answer"], stored["who"]) == ("clear", "yes", "emulated operator")
    assert [entry["event"] for entry in parts.bench.published] == ["prompt", "answer"]


async def test_an_unanswered_question_is_stored_too(parts: Parts) -> None:
    with pytest.raises(PromptUnansweredError, match="answers file"):
        await parts.ctx.ask(Prompt("name", "text", "Type the name."))
    assert parts.reader.prompts()[0]["answer"] is None


async def test_what_hands_did_for_an_answer_is_in_the_run(parts: Parts) -> None:
    await parts.ctx.ask(Prompt("stage/1", "confirm", "Clear it.", task=ClearBeam()))
    hands = [event for event in parts.reader.events() if event.kind == "hands"]
    assert [event.data for event in hands] == [{"prompt": "stage/1", "did": "clear-beam"}]
    with pytest.raises(LinkFailedError, match="stuck"):
        await parts.ctx.ask(Prompt("stage/2", "confirm", "Turn.", task=TurnScrew(screw="stage", turns=1.0)))
    assert [(prompt["id"], prompt["answer"]) for prompt in parts.reader.prompts()] == [
        ("stage/1", "yes"),
        ("stage/2", None),
    ]


async def test_progress_estimates_from_the_runs_own_pace(parts: Parts) -> None:
    parts.ctx.progress(100.0, 300.0)
    parts.bench.clock.advance(20.0)
    parts.ctx.progress(110.0, 300.0, "row 2")
    last = parts.bench.published[-1]
    # Ten expected seconds took twenty; the rehearsal counts for a quarter of the 200 that are to do.
    assert (last["elapsed_bench_s"], last["left_bench_s"]) == pytest.approx((20.0, 190.0 * 70.0 / 60.0))


async def test_a_stop_ends_a_question_that_waits(parts: Parts) -> None:
    asked = asyncio.Event()

    async def nobody(_prompt: Prompt) -> Answer | None:
        asked.set()
        await asyncio.Event().wait()
        return None

    operator = Operator(parts.bench.clock, {}, nobody, simulated=False)
    waiting = asyncio.create_task(
        parts.control.command(operator.answer(Prompt("clear", "confirm", "Clear?")))
    )
    await asked.wait()
    parts.control.stop("F12")
    with pytest.raises(Exception, match="F12"):
        await waiting
    await parts.control.halted()


async def test_a_stop_beside_a_live_value_stays_a_stop(parts: Parts, monkeypatch: pytest.MonkeyPatch) -> None:
    """The look and the question are dropped together, and a look that ends slowly must not abort the run."""
    looking = asyncio.Event()

    async def slow_status() -> BeamStatus:
        looking.set()
        try:
            await asyncio.Event().wait()
        finally:
            for _ in range(5):
                # As a driver that ends its frame before it lets go.
                await asyncio.sleep(0)
        raise AssertionError

    async def watch() -> Live:
        await parts.ctx.beam()
        raise AssertionError

    monkeypatch.setattr(parts.bench.counter, "status", slow_status)
    asking = asyncio.create_task(parts.ctx.ask(Prompt("stage/1", "confirm", "Turn."), watch))
    await looking.wait()
    parts.control.stop("F12")
    with pytest.raises(InterruptedRunError, match="F12"):
        await asking
    await parts.control.halted()
    assert parts.control.state == ControlState.STOPPED
    assert parts.bench.robot.calls == ["stop"]
