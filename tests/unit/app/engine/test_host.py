"""Whole runs on scripted instruments: what is stored and sent, what real hardware takes, and how a run goes on."""

import asyncio
import os
import signal
import sqlite3
import stat
from collections.abc import Callable
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import pytest

from catseye.app.engine.conditions import Watchman
from catseye.app.engine.host import run_procedure
from catseye.app.engine.questions import OVERRIDE
from catseye.app.engine.signals import loop_signals
from catseye.app.errors import StorageError, UsageError
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.run_events import RunEvent, StateChanged, StepDone
from catseye.app.store.reader import RunReader
from catseye.app.store.verify import verify
from catseye.drivers.roles.errors import AlarmError, LinkError
from catseye.drivers.roles.robot import RobotAbilities
from catseye.procedures.kit.context import Context
from catseye.procedures.kit.errors import ReflectorNotFoundError
from catseye.procedures.kit.records import Json, Row
from tests.patience import HANG_S
from tests.unit.app.engine.fakes import FakeBench, Script
from tests.unit.app.engine.runs import measuring, run


@pytest.fixture
def bench(tmp_path: Path) -> FakeBench:
    return FakeBench(tmp_path / "runs")


async def test_a_complete_run_is_stored_sealed_and_published(bench: FakeBench) -> None:
    procedure = measuring(0, 1, 2)
    outcome = await run(bench, procedure, meta={"operator": "Ada"})
    assert (outcome.status, outcome.exit_code, outcome.text) == ("complete", ExitCode.DONE, "")
    reader = RunReader(outcome.path)
    assert (reader.status, reader.exit_code) == ("complete", 0)
    assert len(reader.rows("points")) == 3
    assert verify(outcome.path).ok
    assert reader.meta["operator"] == "Ada"
    assert reader.meta["simulated"] is True
    assert bench.states() == ["STARTING", "EXECUTE", "COMPLETE"]
    assert bench.said("run-ended")[0]["exit_code"] == 0
    assert bench.published[0]["event"] == "run-started"
    assert bench.published[-1]["event"] == "run-ended"
    assert procedure.torn_down == 1
    assert len(outcome.step_times) == 3


async def test_what_an_earlier_run_left_is_said_with_a_failure(bench: FakeBench) -> None:
    async def body(_ctx: Context) -> None:
        raise ReflectorNotFoundError("P1 was not found")

    left = "open-loop-1 left the interferometer turned by 178.8°"
    outcome = await run(bench, Script(body), aftermath=left)
    assert (outcome.status, outcome.text) == ("failed", f"P1 was not found. {left}")
    assert left in [event["text"] for event in bench.said("warning")]


async def test_the_override_is_lowered_before_the_drives_are_on(bench: FakeBench) -> None:
    await run(bench, measuring(0))
    assert bench.robot.calls[:4] == ["connect", "override 20", "servo on", "move"]
    assert bench.robot.calls[-2:] == ["servo off", "close"]


async def test_drives_that_are_kept_are_said(bench: FakeBench) -> None:
    outcome = await run(bench, measuring(0), keep_drives=True)
    assert outcome.drives_on
    assert "servo off" not in bench.robot.calls
    (drives,) = [said["data"] for said in bench.said("drives-left")]
    assert drives == {
        "on": True,
        "text": "the drives stay on: the arm holds its place and can be moved at once",
    }
    assert bench.said("run-ended")[0]["drives_on"] is True
    assert [e.data for e in RunReader(outcome.path).events() if e.kind == "drives"] == [drives]


async def test_an_abort_switches_drives_off_that_were_to_be_kept(bench: FakeBench) -> None:
    bench.robot.move_error = AlarmError("alarm 2500: look at the drive", 2500)
    outcome = await run(bench, measuring(0), keep_drives=True)
    assert (outcome.status, outcome.drives_on) == ("aborted", False)
    assert bench.robot.calls[-3:] == ["stop", "servo off", "close"]


async def test_drives_that_do_not_go_off_are_said(bench: FakeBench, monkeypatch: pytest.MonkeyPatch) -> None:
    switch = bench.robot.servo

    async def servo(*, on: bool) -> None:
        if not on:
            raise LinkError("robot: link lost")
        await switch(on=on)

    monkeypatch.setattr(bench.robot, "servo", servo)
    outcome = await run(bench, measuring(0))
    assert (outcome.status, outcome.drives_on) == ("complete", True)
    (drives,) = [said["data"] for said in bench.said("drives-left")]
    assert isinstance(drives, dict)
    assert "not certain to be off: switch them off at the controller (robot: link lost)" in str(
        drives["text"]
    )


async def test_drives_that_nobody_switches_are_left_to_an_operator(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def rest() -> str:
        return "the program is held; switch the drives off at the controller"

    monkeypatch.setattr(type(bench.robot), "abilities", RobotAbilities(switches_drives=False))
    monkeypatch.setattr(bench.robot, "rest", rest)
    outcome = await run(bench, measuring(0), keep_drives=True)
    # Nobody counts down to drives that no program switches off.
    assert (outcome.status, outcome.drives_on) == ("complete", None)
    assert "servo off" not in bench.robot.calls
    (drives,) = [said["data"] for said in bench.said("drives-left")]
    assert drives == {"on": True, "text": await rest()}


async def test_an_arm_of_which_nothing_is_known_is_said(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def rest() -> str:
        raise LinkError("robot: link lost")

    monkeypatch.setattr(type(bench.robot), "abilities", RobotAbilities(switches_drives=False))
    monkeypatch.setattr(bench.robot, "rest", rest)
    await run(bench, measuring(0))
    (drives,) = [said["data"] for said in bench.said("drives-left")]
    assert "what holds the arm is not known" in str(drives)
    assert "link lost" in str(drives)


@pytest.mark.parametrize(("answer", "status"), [("yes", "complete"), ("no", "aborted")])
async def test_an_override_of_0_is_raised_by_consent_only(bench: FakeBench, answer: str, status: str) -> None:
    bench.robot.state = replace(bench.robot.state, override_percent=0.0)
    outcome = await run(bench, measuring(0), answers={OVERRIDE.id: answer})
    assert outcome.status == status
    assert ("override 20" in bench.robot.calls) == (answer == "yes")
    assert ("move" in bench.robot.calls) == (answer == "yes")
    if answer == "no":
        assert outcome.exit_code == ExitCode.SAFETY
        assert "raise it at the controller to at most the 20 %" in outcome.text


async def test_a_run_that_is_slower_than_planned_says_so(bench: FakeBench) -> None:
    bench.robot.state = replace(bench.robot.state, override_percent=5.0)
    outcome = await run(bench, measuring(0))
    slow = [text for text in (str(event["text"]) for event in bench.said("warning")) if "override" in text]
    assert len(slow) == 1
    assert "is 5 % and the run is planned with 20 %" in slow[0]
    assert any("is 5 %" in str(event) for event in RunReader(outcome.path).events())
    # It is never raised.
    assert "override 20" not in bench.robot.calls


@pytest.mark.parametrize("percent", [19.5, 20.0, 100.0])
async def test_a_run_as_fast_as_planned_says_nothing(bench: FakeBench, percent: float) -> None:
    bench.robot.state = replace(bench.robot.state, override_percent=percent)
    await run(bench, measuring(0))
    assert not [event for event in bench.said("warning") if "override" in str(event["text"])]


async def test_an_emulated_run_wears_a_banner(bench: FakeBench) -> None:
    await run(bench, measuring(0))
    assert "SIMULATION" in str(bench.said("warning")[0]["text"])


async def test_the_transcript_is_part_of_the_run(bench: FakeBench) -> None:
    outcome = await run(bench, measuring(0))
    assert '"hex":"68656c6c6f0d","text":"hello."' in (outcome.path / "wire.log").read_text()


async def test_an_override_that_reads_back_above_the_cap_is_refused(bench: FakeBench) -> None:
    bench.robot.overrides = [50.0]
    outcome = await run(bench, measuring(0))
    assert (outcome.status, outcome.exit_code) == ("aborted", ExitCode.SAFETY)
    assert "reads 50 %" in outcome.text
    assert "move" not in bench.robot.calls
    assert "servo on" not in bench.robot.calls


async def test_all_devices_that_fail_are_reported_together(bench: FakeBench) -> None:
    bench.robot.connect_error = LinkError("tcp://a refused: switch it on")
    bench.air.connect_error = LinkError("tcp://b silent: look at the cable")
    outcome = await run(bench, measuring(0))
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.DEVICE)
    assert outcome.text == (
        "2 of 3 devices cannot be used:\n"
        "  robot: tcp://a refused: switch it on\n"
        "  environment: tcp://b silent: look at the cable"
    )
    assert bench.robot.calls == ["connect", "close"]


class Permission(NamedTuple):
    arm: str | None
    code: ExitCode
    text: str


@pytest.mark.parametrize(
    "case",
    [
        Permission(None, ExitCode.USAGE, "--arm lab-1"),
        Permission("lab-2", ExitCode.SAFETY, "'lab-2' and the cell is 'lab-1'"),
    ],
)
async def test_real_hardware_needs_the_cells_name(bench: FakeBench, case: Permission) -> None:
    bench.make_real()
    outcome = await run(bench, measuring(0), arm=case.arm)
    assert outcome.exit_code == case.code
    assert case.text in outcome.text
    assert bench.robot.calls == ["connect", "close"]


async def test_armed_real_hardware_runs_without_a_banner(bench: FakeBench) -> None:
    bench.make_real()
    outcome = await run(bench, measuring(0), arm="lab-1")
    assert outcome.status == "complete"
    (warning,) = bench.said("warning")
    assert str(warning["text"]).startswith("no door is watched: the cell file has no [io]")
    assert RunReader(outcome.path).meta["simulated"] is False


@pytest.mark.parametrize(("real", "aimed"), [(True, True), (False, False)])
async def test_an_aim_from_another_world_moves_nothing(bench: FakeBench, real: bool, aimed: bool) -> None:
    if real:
        bench.make_real()
    outcome = await run(bench, measuring(0), arm="lab-1", aim_simulated=aimed)
    assert outcome.exit_code == ExitCode.SAFETY
    assert f"a search on {'emulated' if aimed else 'real'} devices" in outcome.text
    assert bench.robot.calls == ["connect", "close"]


async def test_real_hardware_runs_in_real_time_only(bench: FakeBench) -> None:
    bench.make_real()
    outcome = await run(bench, measuring(0), arm="lab-1", clock_speed=10.0)
    assert outcome.exit_code == ExitCode.USAGE
    assert "--speed" in outcome.text


async def test_a_run_does_not_change_between_emulated_and_real_devices(bench: FakeBench) -> None:
    bench.robot.move_error = LinkError("lost")
    first = await run(bench, measuring(0))
    bench.make_real()
    calls = len(bench.robot.calls)
    second = await run(bench, measuring(0), arm="lab-1", resume=first.path)
    assert second.exit_code == ExitCode.SAFETY
    assert "begun with emulated devices" in second.text
    assert bench.robot.calls[calls:] == ["connect", "close"]


@pytest.mark.parametrize("silent", [False, True], ids=["stored", "format 1"])
async def test_a_run_is_not_resumed_with_another_air_correction(bench: FakeBench, silent: bool) -> None:
    bench.robot.move_error = LinkError("lost")
    first = await run(bench, measuring(0))
    if silent:
        with closing(sqlite3.connect(first.path / "run.sqlite")) as stored:
            stored.executescript("DROP TRIGGER meta_no_delete; DELETE FROM meta WHERE key = 'compensation'")
    bench.counter.compensated = "none"
    second = await run(bench, measuring(0), resume=first.path)
    assert second.exit_code == ExitCode.USAGE
    assert "begun with another correction" in second.text


async def test_a_run_learns_its_devices_on_resuming(bench: FakeBench) -> None:
    bench.robot.connect_error = LinkError("off")
    first = await run(bench, measuring(0))
    bench.robot.connect_error = None
    await run(bench, measuring(0), resume=first.path)
    assert RunReader(first.path).meta["simulated"] is True


async def test_emulated_and_real_devices_are_not_mixed(bench: FakeBench) -> None:
    bench.make_real()
    bench.air.simulated = True
    outcome = await run(bench, measuring(0), arm="lab-1")
    assert outcome.exit_code == ExitCode.SAFETY
    assert "emulated (environment)" in outcome.text


async def test_a_resumed_run_repeats_only_what_was_not_done(bench: FakeBench) -> None:
    async def dies(ctx: Context) -> None:
        await measuring(0, 1).run(ctx, None)
        raise LinkError("lost")

    first = await run(bench, Script(dies))
    moves = bench.robot.calls.count("move")
    second = await run(bench, measuring(0, 1, 2), resume=first.path)
    assert second.path == first.path
    assert second.status == "complete"
    assert bench.robot.calls.count("move") == moves + 1
    reader = RunReader(second.path)
    assert [row["theta1_deg"] for row in reader.rows("points")] == [0.0, 1.0, 2.0]
    assert [event.kind for event in reader.events()].count("run-reopened") == 1
    assert verify(second.path).ok


async def test_a_complete_run_is_not_resumed(bench: FakeBench) -> None:
    first = await run(bench, measuring(0))
    with pytest.raises(UsageError, match="is complete"):
        await run(bench, measuring(0), resume=first.path)
    assert not first.path.joinpath("run.sqlite").stat().st_mode & stat.S_IWUSR


async def test_a_lost_front_end_holds_the_run(bench: FakeBench) -> None:
    events: list[Json] = []

    def publish(event: RunEvent) -> None:
        events.append(event.event)
        if isinstance(event, StepDone):
            asyncio.get_running_loop().call_later(0, bench.signal, signal.SIGTERM)
            raise BrokenPipeError("closed")

    request = bench.request(measuring(0, 1))
    outcome = await run_procedure(request, bench.build, bench.clock, publish, bench.install)
    assert outcome.exit_code == ExitCode.TERMINATED
    assert bench.robot.calls.count("move") == 1
    states = [event.data["state"] for event in RunReader(outcome.path).events() if event.kind == "state"]
    assert states[2:] == ["HOLDING", "HELD", "ABORTING", "ABORTED"]
    assert events[-1] == "run-ended"


@pytest.mark.parametrize("lost_at", ["run-started", "STARTING", "warning", "EXECUTE"])
async def test_losing_the_front_end_before_motion_holds_the_run(bench: FakeBench, lost_at: str) -> None:
    def publish(event: RunEvent) -> None:
        state = event.state if isinstance(event, StateChanged) else None
        if state == "HELD":
            asyncio.get_running_loop().call_later(0, bench.signal, signal.SIGTERM)
        if lost_at in {event.event, state}:
            raise BrokenPipeError("closed")

    request = bench.request(measuring(0))
    async with asyncio.timeout(HANG_S):
        outcome = await run_procedure(request, bench.build, bench.clock, publish, bench.install)
    assert outcome.exit_code == ExitCode.TERMINATED
    assert "move" not in bench.robot.calls


def lost_after_a_step(events: list[RunEvent]) -> Callable[[RunEvent], None]:
    """Return what takes events until the first step is done, and nothing from then on."""

    def publish(event: RunEvent) -> None:
        events.append(event)
        if any(isinstance(earlier, StepDone) for earlier in events):
            raise BrokenPipeError("closed")

    return publish


async def test_a_run_goes_on_without_a_reader(bench: FakeBench) -> None:
    events: list[RunEvent] = []
    request = bench.request(measuring(0, 1), on_output_lost="go-on")
    outcome = await run_procedure(request, bench.build, bench.clock, lost_after_a_step(events), bench.install)
    assert outcome.status == "complete"
    stored = {event.kind: event.data for event in RunReader(outcome.path).events()}
    assert stored["output-lost"] == {"reason": "closed", "policy": "go-on"}
    # All after the first step's end but the last event, which is published when the record is sealed.
    first = next(number for number, event in enumerate(events) if isinstance(event, StepDone))
    assert stored["output-missed"] == {"events": len(events) - first - 1}


async def test_a_run_without_a_reader_stops_if_asked_to(bench: FakeBench) -> None:
    request = bench.request(measuring(0, 1), on_output_lost="stop")
    outcome = await run_procedure(request, bench.build, bench.clock, lost_after_a_step([]), bench.install)
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.INTERRUPTED)
    assert RunReader(outcome.path).count("steps") == 1


async def test_a_watchman_who_fails_ends_the_run(bench: FakeBench, monkeypatch: pytest.MonkeyPatch) -> None:
    async def fails(_self: Watchman) -> None:
        raise ValueError("not a number")

    async def patient(ctx: Context) -> None:
        await ctx.step("wait", "wait", nothing)
        await ctx.pause(100.0)

    async def nothing() -> Row:
        return {}

    monkeypatch.setattr(Watchman, "watch", fails)
    async with asyncio.timeout(HANG_S):
        outcome = await run(bench, Script(patient))
    assert outcome.status == "failed"
    assert outcome.text.startswith("internal error: ValueError: not a number; this is a fault of the program")
    assert "stop" in bench.robot.calls


async def test_no_run_is_begun_where_it_could_not_be_stored(bench: FakeBench) -> None:
    with pytest.raises(StorageError, match="MB free"):
        await run(bench, measuring(0), reserve_bytes=1 << 60)
    assert bench.robot.calls == []


async def test_signals_of_the_process_arrive_while_installed() -> None:
    seen: list[int] = []
    arrived = asyncio.Event()

    def on_signal(number: int) -> None:
        seen.append(number)
        arrived.set()

    with loop_signals(on_signal):
        os.kill(os.getpid(), signal.SIGUSR1)
        await arrived.wait()
    assert seen == [signal.SIGUSR1]
    assert signal.getsignal(signal.SIGUSR1) == signal.SIG_DFL
