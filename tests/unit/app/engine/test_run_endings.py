"""How runs end that do not come to their own end: what becomes of robot, record and exit code."""

import asyncio
import signal
from pathlib import Path
from typing import Any

import pytest

from catseye.app.engine.host import run_procedure
from catseye.app.engine.request import RunOutcome
from catseye.app.errors import MeasurementRejectedError, StorageError
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.run_events import RunEvent
from catseye.app.store.reader import RunReader
from catseye.app.store.resumable import why_not_resumable
from catseye.app.store.run_store import RunStore
from catseye.app.store.verify import verify
from catseye.drivers.roles.clock import Clock
from catseye.drivers.roles.device import Identity
from catseye.drivers.roles.errors import AlarmError, LinkError
from catseye.procedures.kit.context import Context, Prompt
from catseye.procedures.kit.errors import BeamLostError, CounterError
from catseye.procedures.kit.records import Row
from tests.unit.app.engine.fakes import AWAY, FakeBench, FakeRobot, Script
from tests.unit.app.engine.runs import measuring, run


@pytest.fixture
def bench(tmp_path: Path) -> FakeBench:
    return FakeBench(tmp_path / "runs")


async def test_a_device_error_stops_the_robot_and_fails_the_run(bench: FakeBench) -> None:
    bench.robot.move_error = LinkError("robot: link lost")
    procedure = measuring(0)
    outcome = await run(bench, procedure)
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.DEVICE)
    assert bench.robot.calls[-3:] == ["stop", "servo off", "close"]
    assert bench.states()[-2:] == ["STOPPING", "STOPPED"]
    assert procedure.torn_down == 1
    assert RunReader(outcome.path).rows("points") == []
    assert "link lost" in str(bench.said("error")[0]["text"])


@pytest.mark.parametrize(
    ("error", "goes_on"),
    [(CounterError("the sign is reversed"), False), (BeamLostError("the beam stays away"), True)],
)
async def test_a_run_with_rejected_data_never_goes_on(
    bench: FakeBench, error: Exception, goes_on: bool
) -> None:
    async def body(_ctx: Context) -> None:
        raise error

    outcome = await run(bench, Script(body))
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.REJECTED)
    assert [said.get("rejected", False) for said in bench.said("run-ended")] == [not goes_on]
    why_not = why_not_resumable(RunReader(outcome.path))
    assert ("the sign is reversed; what it has stored would be rejected again" in why_not) is not goes_on


async def test_an_alarm_aborts_and_skips_the_teardown(bench: FakeBench) -> None:
    bench.robot.move_error = AlarmError("alarm 2500: look at the drive", 2500)
    procedure = measuring(0)
    outcome = await run(bench, procedure)
    assert (outcome.status, outcome.exit_code) == ("aborted", ExitCode.SAFETY)
    assert procedure.torn_down == 0
    assert bench.states()[-1] == "ABORTED"


async def test_drives_that_go_off_abort(bench: FakeBench) -> None:
    async def body(ctx: Context) -> None:
        await bench.robot.servo(on=False)
        await ctx.move(AWAY)

    outcome = await run(bench, Script(body))
    assert (outcome.status, outcome.exit_code) == ("aborted", ExitCode.SAFETY)


async def test_a_target_outside_the_limits_fails_without_motion(bench: FakeBench) -> None:
    async def body(ctx: Context) -> None:
        await ctx.move((200.0, 0.0, 0.0, 0.0))

    outcome = await run(bench, Script(body))
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.SAFETY)
    assert "move" not in bench.robot.calls


async def test_a_rejected_measurement_has_its_exit_code(bench: FakeBench) -> None:
    async def body(_ctx: Context) -> None:
        raise MeasurementRejectedError("too noisy: look at the signal")

    outcome = await run(bench, Script(body))
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.REJECTED)


async def test_an_unanswered_prompt_on_real_hardware(bench: FakeBench) -> None:
    async def body(ctx: Context) -> None:
        await ctx.ask(Prompt("clear", "confirm", "Confirm that the cell is clear.", motion=True))

    bench.make_real()
    outcome = await run(bench, Script(body), arm="lab-1", answers={"clear": "yes"})
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.TIMEOUT)


async def test_a_fault_of_the_program_still_leaves_everything_in_order(bench: FakeBench) -> None:
    async def body(_ctx: Context) -> None:
        raise ZeroDivisionError("division by zero")

    outcome = await run(bench, Script(body))
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.FAULT)
    text = (
        "internal error: ZeroDivisionError: division by zero; this is a fault of the program, "
        "app.log of the run shows where"
    )
    assert outcome.text == text
    assert [event["text"] for event in bench.said("error")] == [text]
    assert "Traceback" in (outcome.path / "app.log").read_text()
    assert verify(outcome.path).ok


class AcmeError(Exception):
    """Of a procedure that somebody else wrote."""


@pytest.mark.parametrize(("debug", "shown"), [("", False), ("1", True)])
async def test_an_error_of_a_procedure_shows_where_when_asked(
    debug: str, shown: bool, bench: FakeBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    async def measures_badly(_ctx: Context) -> None:
        raise AcmeError("the gauge is upside down")

    monkeypatch.setenv("CATSEYE_DEBUG", debug)
    outcome = await run(bench, Script(measures_badly))
    (event,) = bench.said("error")
    assert "AcmeError: the gauge is upside down" in outcome.text
    assert ("in measures_badly" in str(event.get("trace"))) is shown
    assert "Traceback" not in outcome.text


async def test_a_stop_after_a_fault_names_the_fault(bench: FakeBench) -> None:
    bench.robot.move_error = KeyError("theta1")
    outcome = await run(bench, measuring(0))
    reasons = [str(event["reason"]) for event in bench.said("state") if event["state"] == "STOPPING"]
    assert len(reasons) == 1
    assert reasons[0].startswith("internal error: KeyError: 'theta1'; this is a fault of the program")
    assert outcome.text == reasons[0]


async def test_a_teardown_that_fails_fails_a_complete_run(bench: FakeBench) -> None:
    async def nothing(_ctx: Context) -> None:
        """Do nothing."""

    async def teardown(_ctx: Context) -> None:
        raise LinkError("lost")

    procedure = Script(nothing, teardown)
    outcome = await run(bench, procedure)
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.DEVICE)
    assert procedure.torn_down == 1


async def test_a_teardown_is_bounded(bench: FakeBench) -> None:
    async def body(_ctx: Context) -> None:
        raise LinkError("lost")

    async def teardown(_ctx: Context) -> None:
        # The deadline is set when both have begun to wait.
        asyncio.get_running_loop().call_later(0, lambda: bench.clock.advance(60.0))
        await asyncio.Event().wait()

    outcome = await run(bench, Script(body, teardown))
    assert outcome.exit_code == ExitCode.DEVICE
    assert "not over after 60 s" in str(bench.said("error")[-1]["text"])


async def stopped_while_moving(bench: FakeBench, *numbers: int) -> tuple[RunOutcome, Script]:
    """Run until the robot moves, then send signals."""
    bench.robot.blocks = True
    procedure = measuring(0)
    running = asyncio.create_task(run(bench, procedure))
    await bench.robot.moving.wait()
    for number in numbers:
        bench.signal(number)
    return await running, procedure


async def test_two_ctrl_c_during_a_move_stop_resumably(bench: FakeBench) -> None:
    outcome, procedure = await stopped_while_moving(bench, signal.SIGINT, signal.SIGINT)
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.INTERRUPTED)
    moved = bench.robot.calls[bench.robot.calls.index("move") :]
    assert moved == ["move", "stop", "move cancelled", "servo off", "close"]
    assert procedure.torn_down == 1
    assert bench.states() == ["STARTING", "EXECUTE", "HOLDING", "STOPPING", "STOPPED"]
    stored = [event.data["state"] for event in RunReader(outcome.path).events() if event.kind == "state"]
    assert stored == bench.states()


@pytest.mark.parametrize(
    ("numbers", "code"),
    [
        ((signal.SIGINT,) * 3, ExitCode.INTERRUPTED),
        ((signal.SIGTERM,), ExitCode.TERMINATED),
        ((signal.SIGHUP,), ExitCode.TERMINATED),
    ],
)
async def test_an_abort_skips_the_teardown(
    bench: FakeBench, numbers: tuple[int, ...], code: ExitCode
) -> None:
    outcome, procedure = await stopped_while_moving(bench, *numbers)
    assert (outcome.status, outcome.exit_code) == ("aborted", code)
    assert procedure.torn_down == 0
    assert verify(outcome.path).ok


async def test_a_robot_ignoring_stop_loses_drives_and_aborts(bench: FakeBench) -> None:
    bench.robot.ignores_stop = True
    outcome, _ = await stopped_while_moving(bench, signal.SIGINT, signal.SIGINT)
    assert (outcome.status, outcome.exit_code) == ("aborted", ExitCode.SAFETY)
    assert "drives were switched off" in outcome.text
    assert "servo off" in bench.robot.calls


async def test_a_cancelled_run_stops_the_robot_and_closes_the_record(bench: FakeBench) -> None:
    bench.robot.blocks = True
    running = asyncio.create_task(run(bench, measuring(0)))
    await bench.robot.moving.wait()
    running.cancel()
    with pytest.raises(asyncio.CancelledError):
        await running
    assert bench.robot.calls[-4:] == ["stop", "move cancelled", "servo off", "close"]
    ended = bench.said("run-ended")[0]
    assert (ended["status"], ended["exit_code"]) == ("aborted", 143)
    assert RunReader(Path(str(ended["path"]))).status == "aborted"


async def test_who_hears_of_a_run_can_stop_it(bench: FakeBench) -> None:
    def heard(event: RunEvent) -> None:
        bench.publish(event)
        if event.event == "run-started":
            bench.signal(signal.SIGINT)

    request = bench.request(measuring(0))
    outcome = await run_procedure(request, bench.build, bench.clock, heard, bench.install)
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.INTERRUPTED)
    assert not [call for call in bench.robot.calls if call.startswith(("move", "servo on"))]


async def test_a_stop_while_devices_connect_ends_the_run(bench: FakeBench) -> None:
    class SlowRobot(FakeRobot):
        async def connect(self) -> Identity:
            bench.signal(signal.SIGINT)
            await asyncio.Event().wait()
            raise AssertionError

    bench.robot = SlowRobot(bench.clock)
    outcome = await run(bench, measuring(0))
    assert (outcome.status, outcome.exit_code) == ("stopped", ExitCode.INTERRUPTED)
    assert bench.robot.calls == ["close"]


async def test_a_storage_failure_stops_the_robot(bench: FakeBench, monkeypatch: pytest.MonkeyPatch) -> None:
    async def broken(*_args: object, **_more: object) -> None:
        raise StorageError("disk full: make room")

    monkeypatch.setattr(RunStore, "append_step", broken)
    outcome = await run(bench, measuring(0, 1))
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.STORAGE)
    assert bench.robot.calls.count("move") == 1
    assert "stop" in bench.robot.calls


async def test_a_storage_failure_during_a_move_stops_it(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    stores: list[RunStore] = []
    create = RunStore.create

    async def remember(root: Path, name: str, meta: Row, clock: Clock, **more: Any) -> RunStore:
        stores.append(await create(root, name, meta, clock, **more))
        return stores[0]

    monkeypatch.setattr(RunStore, "create", remember)
    bench.robot.blocks = True
    running = asyncio.create_task(run(bench, measuring(0)))
    await bench.robot.moving.wait()
    stores[0].on_failure(StorageError("no space: make room"))
    outcome = await running
    assert (outcome.status, outcome.exit_code) == ("failed", ExitCode.STORAGE)
    assert bench.robot.calls[-4:] == ["stop", "move cancelled", "servo off", "close"]
