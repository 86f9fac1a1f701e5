"""Campaigns of resolution tests on scripted instruments and a real store."""

import asyncio
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from catseye.app.engine.devices import Devices, WireRecorder
from catseye.app.engine.dry_run import DryRunContext
from catseye.app.engine.host import run_procedure
from catseye.app.engine.operator import Answer
from catseye.app.engine.request import RunOutcome, RunRequest
from catseye.app.protocol.events import event_of
from catseye.app.protocol.run_events import LiveShown
from catseye.app.store.reader import RunReader
from catseye.app.store.verify import verify
from catseye.drivers.roles.errors import LinkError, RefusedError
from catseye.procedures.kit.context import Prompt
from catseye.procedures.kit.procedure import Procedure
from catseye.procedures.kit.records import Json
from catseye.procedures.kit.system import System
from catseye.procedures.kit.tasks import AlignOptics, MountOptics
from catseye.procedures.resolution.backlash import Backlash, BacklashParams
from catseye.procedures.resolution.campaign_plan import CampaignPlan
from catseye.procedures.resolution.cartesian import CartesianParams, ResolutionCartesian
from catseye.procedures.resolution.resolution import Resolution, ResolutionParams
from tests.unit.app.engine.fakes import FakeBench
from tests.unit.app.engine.given_parts import Willing
from tests.unit.procedures.resolution.benches import SIX, AngleCounter, SteppedArm
from tests.unit.procedures.six_axes import STRETCHED

SHORT = ResolutionParams(
    joints=["A1"],
    positions=["K3"],
    steps=6,
    standstill_s=15.0,
    dwell_s=2.0,
    # The scripted clock goes on while others look at the bench: 5 readings a second.
    accept_slow_counter=True,
)
STRICT = SHORT.model_copy(update={"accept_slow_counter": False})


@dataclass
class Room(FakeBench):
    """A bench with a stepped arm, optics on its first axis, and somebody who answers."""

    asked: list[Prompt] = field(default_factory=list)
    answers: dict[str, str | Callable[[], str]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        super().__post_init__()
        self.arm = SteppedArm(self.clock, pose=STRETCHED)
        self.robot = self.arm
        self.angle = AngleCounter(self.clock, arm=self.arm)
        self.counter = self.angle

    def build(self, record: WireRecorder) -> Devices:
        record("robot", "tx", b"hello\r")
        return Devices(self.robot, self.counter, self.air)

    async def answer(self, prompt: Prompt) -> Answer:
        self.asked.append(prompt)
        given = self.answers.get(prompt.id)
        text = given() if callable(given) else given
        return Answer(text or (prompt.choices[0] if prompt.choices else "yes"), "Ada")

    def request_of(self, procedure: Procedure, plan: CampaignPlan, **changes: Any) -> RunRequest:
        hands = Willing("tcp://127.0.0.1:1")
        base = self.request(None, driven=SIX.arm, answerer=self.answer, hands=hands, **changes)  # type: ignore[arg-type]  # set next
        return replace(base, procedure=procedure, plan=plan)


async def carried_out(room: Room, procedure: Procedure, plan: CampaignPlan, **changes: Any) -> RunOutcome:
    request = room.request_of(procedure, plan, **changes)
    return await run_procedure(request, room.build, room.clock, room.publish, room.install)


def number(value: Json) -> float:
    assert isinstance(value, float)
    return value


def moves_of(reader: RunReader, step_id: str) -> list[dict[str, Json]]:
    return [row for row in reader.rows("moves") if row["step_id"] == step_id]


async def test_a_campaign_records_every_series(tmp_path: Path) -> None:
    room = Room(tmp_path)
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    assert (outcome.status, outcome.text) == ("complete", "")
    reader = RunReader(outcome.path)
    assert [step.step_id for step in reader.steps()] == ["A1/K3/optics", "A1/K3/+", "A1/K3/-"]
    sizes = [0.1 / 1.072267**n for n in range(6)]
    assert {axis for axis, _ in room.arm.steps} == {"A1"}
    assert [by for _, by in room.arm.steps] == pytest.approx([*sizes, *(-size for size in sizes)])
    assert verify(outcome.path).problems == ()
    assert [prompt.id for prompt in room.asked] == ["drive/A1/K3", "mount/A1/K3", "align/A1/K3/1"]
    assert [prompt.task for prompt in room.asked] == [
        None,
        MountOptics(optics="angular", on="A1"),
        AlignOptics(),
    ]


async def test_moves_say_when_and_by_how_much(tmp_path: Path) -> None:
    room = Room(tmp_path)
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    reader = RunReader(outcome.path)
    moves = moves_of(reader, "A1/K3/-")
    assert [row["command"] for row in moves] == pytest.approx([-0.1 / 1.072267**n for n in range(6)])
    first, second = moves[:2]
    # Ten seconds of standstill, then moves of a second with two seconds after each; the scripted clock goes on
    # while others look at the bench.
    assert number(first["time_s"]) >= 10.0
    assert number(first["ended_s"]) - number(first["time_s"]) >= 1.0
    assert number(second["time_s"]) - number(first["ended_s"]) >= 2.0
    # The scripted arm does nine tenths of each step, beginning at 0 after the run-in.
    assert first["measured_before"] == 0.0
    assert first["measured_after"] == pytest.approx(-0.09)
    assert first["torque_nm"] == 40.0
    # Read behind the dwell and before the next step.
    assert number(first["ended_s"]) + 2.0 <= number(first["torque_s"]) <= number(second["time_s"])
    configuration = reader.rows("configurations")[1]
    expected = {"test": "decaying", "joint": "A1", "position": "K3", "position_value": 0.0, "direction": -1}
    assert {key: configuration[key] for key in expected} == expected
    assert (configuration["spacing_mm"], configuration["moves"], configuration["absolute"]) == (30.0, 6, 0)


async def test_the_recording_shows_standstill_and_steps(tmp_path: Path) -> None:
    room = Room(tmp_path)
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    reader = RunReader(outcome.path)
    up, _ = reader.recordings()
    readings = [pair for part in reader.chunks(up) for pair in zip(part.times_s, part.values, strict=True)]
    first, second = moves_of(reader, "A1/K3/+")[:2]
    before = [value for time_s, value in readings if time_s < number(first["time_s"])]
    after = [
        value for time_s, value in readings if number(first["ended_s"]) < time_s < number(second["time_s"])
    ]
    assert len(before) > 50
    assert len(after) > 5
    assert before == [0.0] * len(before)
    # Nine tenths of a tenth of a degree on 30 mm: 30 sin 0.09 deg.
    assert after == pytest.approx([0.0471239] * len(after), abs=1e-6)


async def test_the_last_rest_is_as_long_as_the_others(tmp_path: Path) -> None:
    room = Room(tmp_path)
    waits_s = [5.0] * 5

    async def slowly() -> tuple[float, ...]:
        # What a slow controller takes before every order but the one that never follows the last.
        await room.clock.sleep(waits_s.pop() if waits_s else 0.0)
        return (40.0,) * 6

    room.arm.torques = slowly  # type: ignore[method-assign]  # one slow answer
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    reader = RunReader(outcome.path)
    sent_s = [number(move["time_s"]) for move in moves_of(reader, "A1/K3/+")]
    shortest_s = min(later - earlier for earlier, later in pairwise(sent_s))
    assert shortest_s > 8.0
    up, _ = reader.recordings()
    assert list(reader.chunks(up))[-1].times_s[-1] >= sent_s[-1] + 0.95 * shortest_s


async def test_a_lost_beam_begins_the_series_anew(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.angle.dark = {3}
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    assert outcome.status == "complete"
    reader = RunReader(outcome.path)
    recordings = [(row["step_id"], row["name"], row["beam_lost"]) for row in reader.recordings()]
    assert recordings == [
        ("A1/K3/+", "series-1", 1),
        ("A1/K3/+", "series-2", 0),
        ("A1/K3/-", "series-1", 0),
    ]
    assert [row["recording"] for row in reader.rows("configurations")] == ["series-2", "series-1"]
    assert len(room.arm.steps) > 12
    assert verify(outcome.path).problems == ()


async def test_a_beam_that_stays_away_is_asked_about(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.angle.dark = set(range(3, 1000))
    room.answers["beam/A1/K3/+/1"] = "skip"
    room.answers["beam/A1/K3/-/1"] = "stop"
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    assert outcome.status == "failed"
    assert "set the optics up again in another run" in outcome.text
    assert RunReader(outcome.path).result("A1/K3/+") == {"recording": None, "moves": 0}


async def test_a_place_that_is_skipped_is_left_out(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.answers["drive/A1/K3"] = "no"
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    assert outcome.status == "complete"
    assert [step.step_id for step in RunReader(outcome.path).steps()] == ["A1/K3/optics"]
    assert room.arm.targets == []


async def test_optics_that_are_not_mounted_are_not_aligned(tmp_path: Path) -> None:
    room, plan = Room(tmp_path), Resolution().plan(SIX, SHORT)
    room.answers["mount/A1/K3"] = "stop"
    first = await carried_out(room, Resolution(), plan)
    assert first.status == "failed"
    assert "catseye resume" in first.text
    assert [prompt.id for prompt in room.asked] == ["drive/A1/K3", "mount/A1/K3"]
    again = Room(tmp_path)
    again.arm.pose = room.arm.pose
    outcome = await carried_out(again, Resolution(), plan, resume=first.path)
    assert outcome.status == "complete"
    assert "mount/A1/K3" in [prompt.id for prompt in again.asked]


async def test_a_place_is_left_out_at_the_mounting(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.answers["mount/A1/K3"] = "skip"
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    assert outcome.status == "complete"
    assert RunReader(outcome.path).result("A1/K3/optics") == {"skipped": True}
    assert [prompt.id for prompt in room.asked] == ["drive/A1/K3", "mount/A1/K3"]
    assert room.arm.steps == []


async def test_a_weak_signal_is_aligned_again(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.angle.beam = replace(room.angle.beam, signal=0.2)

    def tighten() -> str:
        room.angle.beam = replace(room.angle.beam, signal=0.9)
        return "aligned"

    room.answers["align/A1/K3/2"] = tighten
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    assert outcome.status == "complete"
    row = RunReader(outcome.path).result("A1/K3/optics")
    assert row == {"skipped": False, "alignments": 2, "signal": 0.9}


async def broken_in_its_second_series(tmp_path: Path) -> tuple[Room, CampaignPlan, Path]:
    """Return a bench on which a campaign of two series was broken off in the second one, its plan and its run."""
    room, plan = Room(tmp_path), Resolution().plan(SIX, SHORT)
    step_axis = room.arm.step_axis

    async def broken(axis: str, increment: float) -> None:
        if len(room.arm.steps) == 9:
            raise LinkError("the cable")
        await step_axis(axis, increment)

    room.arm.step_axis = broken  # type: ignore[method-assign]  # the cable is cut in the middle of the second series
    first = await carried_out(room, Resolution(), plan)
    assert first.status == "failed"
    again = Room(tmp_path)
    again.arm.pose = room.arm.pose
    return again, plan, first.path


async def test_a_broken_campaign_goes_on_with_its_series(tmp_path: Path) -> None:
    again, plan, path = await broken_in_its_second_series(tmp_path)
    outcome = await carried_out(again, Resolution(), plan, resume=path)
    assert (outcome.status, outcome.text) == ("complete", "")
    reader = RunReader(outcome.path)
    assert [(step.step_id, step.attempt) for step in reader.steps()] == [
        ("A1/K3/optics", 1),
        ("A1/K3/+", 1),
        ("A1/K3/-", 2),
    ]
    # What was mounted is not asked for again, and the first series is not driven again.
    assert [prompt.id for prompt in again.asked if prompt.task] == []
    assert len(again.arm.steps) == 6
    assert verify(outcome.path).problems == ()


async def test_moved_optics_are_set_up_anew_for_what_is_left(tmp_path: Path) -> None:
    room, plan, path = await broken_in_its_second_series(tmp_path)
    room.answers["resume/reflectors"] = "moved"
    outcome = await carried_out(room, Resolution(), plan, resume=path)
    assert outcome.status == "complete", outcome.text
    asked = [prompt.id for prompt in room.asked]
    assert asked[:4] == ["resume/reflectors", "drive/A1/K3", "mount/A1/K3", "align/A1/K3/1"]
    reader = RunReader(path)
    assert [step.step_id for step in reader.steps()] == ["A1/K3/optics", "A1/K3/+", "A1/K3/-"]
    assert "set-up-lost" in [event.kind for event in reader.events()]
    assert reader.count("configurations") == 2


async def test_a_place_may_be_left_out_when_optics_were_moved(tmp_path: Path) -> None:
    room, plan, path = await broken_in_its_second_series(tmp_path)
    room.answers |= {"resume/reflectors": "moved", "mount/A1/K3": "skip"}
    outcome = await carried_out(room, Resolution(), plan, resume=path)
    assert outcome.status == "complete", outcome.text
    assert RunReader(path).count("configurations") == 1


async def test_backlash_drives_poses_and_reads_torques(tmp_path: Path) -> None:
    room = Room(tmp_path)
    params = BacklashParams(
        joints=["A1"], positions=["K3"], standstill_s=15.0, dwell_s=1.0, accept_slow_counter=True
    )
    outcome = await carried_out(room, Backlash(), Backlash().plan(SIX, params))
    assert outcome.status == "complete"
    reader = RunReader(outcome.path)
    moves = reader.rows("moves")
    assert len(moves) == 105
    assert room.arm.steps == []
    assert [row["command"] for row in moves[:6]] == pytest.approx([-0.1] * 5 + [0.1])
    assert {row["torque_nm"] for row in moves} == {40.0}
    assert reader.rows("configurations")[0]["absolute"] == 1


async def test_a_controller_without_torques_is_told_once(tmp_path: Path) -> None:
    room = Room(tmp_path)

    async def none() -> tuple[float, ...]:
        raise RefusedError("no torques", 0)

    room.arm.torques = none  # type: ignore[method-assign]  # a controller without them
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    reader = RunReader(outcome.path)
    assert {row["torque_nm"] for row in reader.rows("moves")} == {None}
    warnings = [event.text for event in reader.events() if event.kind == "warning"]
    assert sum("no motor torques are recorded" in text for text in warnings) == 1


async def test_straight_series_are_stepped_along_lines(tmp_path: Path) -> None:
    room = Room(tmp_path)
    params = CartesianParams(
        poses_deg=[[0.0, -20.0, 20.0, 0.0, 40.0, 0.0]],
        directions=["-Z"],
        steps=5,
        standstill_s=15.0,
        dwell_s=1.0,
        accept_slow_counter=True,
    )
    outcome = await carried_out(room, ResolutionCartesian(), ResolutionCartesian().plan(SIX, params))
    assert (outcome.status, outcome.text) == ("complete", "")
    assert {line[:2] for line in room.arm.lines} == {(0.0, 0.0)}
    assert [line[2] for line in room.arm.lines] == pytest.approx([-1.0 / 1.072267**n for n in range(5)])
    reader = RunReader(outcome.path)
    row = reader.rows("moves")[0]
    assert (row["joint"], row["measured_before"]) == ("Z", None)
    assert row["command"] == pytest.approx(-1.0)
    assert reader.rows("configurations")[0]["unit"] == "mm"


def slow_counter_warnings(reader: RunReader) -> list[str]:
    warnings = [event.text for event in reader.events() if event.kind == "warning"]
    return [text for text in warnings if "readings a second" in text]


async def test_too_slow_a_counter_ends_the_run_before_a_step(tmp_path: Path) -> None:
    room = Room(tmp_path)
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, STRICT))
    assert outcome.status == "failed"
    assert (
        "and the evaluation needs 20 (19.4 or more is accepted, since clocks differ): lower" in outcome.text
    )
    assert room.arm.steps == []
    assert len(slow_counter_warnings(RunReader(outcome.path))) == 1


async def test_going_on_with_a_slow_counter_is_asked_once(tmp_path: Path) -> None:
    room = Room(tmp_path)
    room.answers["slow-counter"] = "anyway"
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, STRICT))
    assert (outcome.status, len(room.arm.steps)) == ("complete", 12)
    assert [prompt.id for prompt in room.asked].count("slow-counter") == 1


async def test_a_slow_counter_can_be_accepted_beforehand(tmp_path: Path) -> None:
    room = Room(tmp_path)
    outcome = await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    assert outcome.status == "complete"
    assert "slow-counter" not in [prompt.id for prompt in room.asked]
    assert len(slow_counter_warnings(RunReader(outcome.path))) == 1


def test_a_rehearsal_takes_as_long_as_the_plan_says() -> None:
    plan = Resolution().plan(SIX, ResolutionParams(joints=["A1"], positions=["K3"]))
    dry = DryRunContext(System(SIX), STRETCHED, declared=Resolution.records)
    asyncio.run(Resolution().run(dry, plan))
    assert [step.step_id for step in dry.steps] == ["A1/K3/optics", "A1/K3/+", "A1/K3/-"]
    # A minute of standstill, 109 dwells of 5 s, steps at a thousandth of 100 deg/s with 0.2 s of messages each.
    expected_s = 60.0 + 109 * 5.2 + sum(0.1 / 1.072267**n for n in range(109)) / 0.1
    assert dry.steps[1].duration_s == pytest.approx(expected_s, rel=0.01)
    assert plan.duration_s == pytest.approx(dry.total_s, rel=0.05)
    assert dry.steps[1].moves == 2 + 109


async def test_steps_are_shown_as_they_are_made(tmp_path: Path) -> None:
    room = Room(tmp_path)
    await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    events = [event_of(message) for message in room.published]
    steps = [event.data.step for event in events if isinstance(event, LiveShown)]
    made = [step for step in steps if step is not None]
    assert [(step.series, step.number, step.count) for step in made] == [
        (f"A1{sign} at K3", number, 6) for sign in "+-" for number in range(1, 7)
    ]
    # The arm does nine tenths of each step; which way the counter counts is a matter of mounting.
    assert [step.measured for step in made] == pytest.approx([0.9 * step.command for step in made], rel=1e-3)
    assert [step.error_percent for step in made] == pytest.approx([-10.0] * 12, abs=0.1)
    first = [step.measured for step in made[:6]]
    assert [step.position for step in made[:6]] == pytest.approx([sum(first[: n + 1]) for n in range(6)])
    assert {(step.unit, step.torque_nm) for step in made} == {("deg", 40.0)}
    # A counter without noise resolves every step.
    assert not any(step.below for step in made)


# Means of a second, two seconds apart, differ by about the amplitude: three times that is compared with steps of
# 0.1 to 0.07 deg, which are 0.052 to 0.037 mm of the optics.
@pytest.mark.parametrize(("wander_mm", "below"), [(0.03, True), (0.002, False)])
async def test_steps_within_the_noise_are_below_the_instrument(
    tmp_path: Path, wander_mm: float, below: bool
) -> None:
    room = Room(tmp_path)
    room.angle.wander_mm = wander_mm
    await carried_out(room, Resolution(), Resolution().plan(SIX, SHORT))
    events = [event_of(message) for message in room.published]
    made = [event.data.step for event in events if isinstance(event, LiveShown) and event.data.step]
    assert [step.below for step in made] == [below] * 12
