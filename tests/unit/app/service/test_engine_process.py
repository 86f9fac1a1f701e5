"""An engine between its runs: what it starts, what it refuses, and how it ends."""

import asyncio
import json
import os
import signal
import threading
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.cell.model import Hooks
from catseye.app.engine.host import run_procedure
from catseye.app.engine.waiting import cancel
from catseye.app.errors import UsageError
from catseye.app.exitcode import ExitCode
from catseye.app.protocol.requests import Plain, Start, decode_request, request_of
from catseye.app.service import engine_process
from catseye.app.service.address import find_socket
from catseye.app.service.client import EngineClient, connect
from catseye.app.service.engine_process import EngineProcess
from catseye.app.service.errors import RefusedError
from catseye.app.service.manual.drives import RestingDrives
from catseye.app.service.walk.walk import WalkedOverride
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.procedures.kit.context import Context, Prompt
from tests.patience import HANG_S
from tests.unit.app.engine.fakes import FakeBench, Script
from tests.unit.app.service.benches import next_event

DOOR = Prompt("door", "confirm", "Close the door.")


@pytest.fixture
def bench(tmp_path: Path, runtime: Path, monkeypatch: pytest.MonkeyPatch) -> FakeBench:
    """Return a scripted bench on which the engine's runs take place; its procedure asks one question."""
    assert runtime.is_dir()
    bench = FakeBench(tmp_path / "runs")
    bench.root.mkdir()

    async def body(ctx: Context) -> None:
        await ctx.ask(DOOR)
        await ctx.move((10.0, 0.0, 0.0, 0.0))

    def plan(loaded: Any, procedure: str, *_: Any) -> SimpleNamespace:
        if procedure == "unknown":
            raise UsageError("there is no procedure 'unknown'")
        return SimpleNamespace(loaded=loaded, clock_speed=1.0, on_client_lost="stop", walk=None)

    async def carry_out(_planned: Any, _root: Path, publish: Any, **options: Any) -> Any:
        chosen = {"answerer": options["answerer"], "on_open": options["on_open"]}
        request = bench.request(Script(body), **chosen)
        return await run_procedure(request, bench.build, bench.clock, publish, options["install_signals"])

    cell = SimpleNamespace(cell=SimpleNamespace(engine=SimpleNamespace(on_client_lost="stop"), hooks=Hooks()))
    monkeypatch.setattr(engine_process, "load_cell", lambda _path: cell)
    monkeypatch.setattr(engine_process, "parse_params", lambda *_: None)
    monkeypatch.setattr(engine_process, "plan_run", plan)
    monkeypatch.setattr(engine_process, "carry_out", carry_out)
    # A procedure's name stands for the procedure here; it has no parameters.
    monkeypatch.setattr(engine_process, "load_procedure", _Named)
    return bench


class _Named(str):
    """A procedure's name with the attribute that parameters are checked by."""

    params_type = None


@asynccontextmanager
async def serving(
    root: Path, *, metrics: Path | None = None, **options: Any
) -> AsyncIterator["asyncio.Task[ExitCode]"]:
    """Serve while the context is entered; whoever enters ends the engine."""
    ready = asyncio.Event()
    engine = EngineProcess(Path("cell.toml"), root, metrics)
    task = asyncio.create_task(engine.serve(ready.set, **options))
    try:
        async with asyncio.timeout(HANG_S):
            await ready.wait()
            yield task
            await task
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


@asynccontextmanager
async def connected(root: Path) -> AsyncIterator[EngineClient]:
    path = find_socket(root)
    assert path is not None
    async with connect(path, "test", "Ada") as client:
        yield client


@asynccontextmanager
async def engine_client(root: Path) -> AsyncIterator[EngineClient]:
    async with connected(root) as client:
        await client.take_control()
        yield client


async def test_a_hook_hears_of_an_engines_run(
    bench: FakeBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    hooks = Hooks(on=["prompt", "run-ended"], command=["/bin/sh", "-c", f"cat >> {tmp_path / 'told'}"])
    cell = SimpleNamespace(engine=SimpleNamespace(on_client_lost="stop"), hooks=hooks)
    monkeypatch.setattr(engine_process, "load_cell", lambda _path: SimpleNamespace(cell=cell))
    async with serving(bench.root), engine_client(bench.root) as client:
        await client.request(Start(procedure="script"))
        await next_event(client, "prompt", id="door")
        await client.answer("door", "yes")
        await next_event(client, "idle", state="COMPLETE")
        await client.request(Plain(op="shutdown"))
    told = [json.loads(line) for line in (tmp_path / "told").read_text().splitlines()]
    assert sorted(event["event"] for event in told) == ["prompt", "run-ended"]


async def test_an_engine_keeps_the_metrics_of_each_run(
    bench: FakeBench, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    cell = SimpleNamespace(engine=SimpleNamespace(on_client_lost="stop"), hooks=Hooks(), name="lab-1")
    planned = SimpleNamespace(
        loaded=SimpleNamespace(cell=cell),
        procedure=SimpleNamespace(name="script"),
        clock_speed=1.0,
        on_client_lost="stop",
        walk=None,
    )
    monkeypatch.setattr(engine_process, "plan_run", lambda *_: planned)
    file = tmp_path / "run.prom"
    async with serving(bench.root, metrics=file), engine_client(bench.root) as client:
        for _ in range(2):
            opened = await client.request(Start(procedure="script"))
            await next_event(client, "prompt", id="door")
            await client.answer("door", "yes")
            await next_event(client, "idle", state="COMPLETE")
            labels = f'cell="lab-1",procedure="script",run="{opened["run"]}"'
            lines = file.read_text(encoding="utf-8").splitlines()
            assert f"catseye_run_exit_code{{{labels}}} 0.0" in lines
            assert f'catseye_run_state{{{labels},catseye_run_state="COMPLETE"}} 1.0' in lines
        await client.request(Plain(op="shutdown"))


async def test_a_client_starts_successive_runs_and_ends_the_engine(bench: FakeBench) -> None:
    async with serving(bench.root) as engine, engine_client(bench.root) as client:
        assert client.snapshot.state == "IDLE"
        for _ in range(2):
            opened = await client.request(Start(procedure="script"))
            with pytest.raises(RefusedError, match="a run is under way"):
                await client.request(Start(procedure="script"))
            with pytest.raises(RefusedError, match="a run is under way"):
                await client.request(Plain(op="shutdown"))
            assert find_socket(Path(str(opened["path"]))) is not None
            # Nobody but a client is there to answer, so the question waits.
            await next_event(client, "prompt", id="door")
            await client.answer("door", "yes")
            assert (await next_event(client, "run-ended"))["status"] == "complete"
            await next_event(client, "idle", state="COMPLETE")
        assert bench.robot.calls.count("move") == 2
        await client.request(Plain(op="shutdown"))
        assert await engine == ExitCode.DONE
    assert find_socket(bench.root) is None


async def test_a_walk_leaves_an_override_to_set_again(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    arm = SimpleNamespace(override_percent=20.0)
    walk = SimpleNamespace(override=WalkedOverride(50.0, 10.0, 10.0))

    def as_walk(planned: SimpleNamespace, _root: Path) -> SimpleNamespace:
        return SimpleNamespace(**vars(planned) | {"walk": walk, "bench": SimpleNamespace(arm=arm)})

    monkeypatch.setattr(engine_process, "as_walk", as_walk)
    async with serving(bench.root), engine_client(bench.root) as client:
        await client.request(Start(procedure="script", walk=True))
        await next_event(client, "prompt", id="door")
        await client.answer("door", "yes")
        left = (await next_event(client, "override-left"))["left"]
        # The cell's cap, not the 50 % that stood there.
        assert left == {"before_percent": 20.0, "left_percent": 10.0}
        await client.request(Plain(op="shutdown"))


async def test_nothing_begins_after_an_unacknowledged_stop_until_it_is_cleared(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = vars(engine_process)["carry_out"]

    async def stopped(*given: Any, **options: Any) -> Any:
        found = await whole(*given, **options)
        return replace(found, status="stopped", unacknowledged="the guard stopped the arm")

    monkeypatch.setattr(engine_process, "carry_out", stopped)
    async with serving(bench.root), engine_client(bench.root) as client:
        await client.request(Start(procedure="script"))
        await next_event(client, "prompt", id="door")
        await client.answer("door", "yes")
        await next_event(client, "idle", state="ABORTED")
        for request in ({"op": "start", "procedure": "script"}, {"op": "jog", "on": True, "percent": 5}):
            with pytest.raises(RefusedError, match="the guard stopped the arm"):
                await client.request(request_of(request))
        await client.request(Plain(op="clear"))
        await client.request(Start(procedure="script"))
        await next_event(client, "prompt", id="door")
        await client.request(Plain(op="stop"))
        await next_event(client, "idle")
        await client.request(Plain(op="shutdown"))


async def test_a_client_joining_during_a_run_sees_no_countdown(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = vars(engine_process)["carry_out"]

    async def left_on(*given: Any, **options: Any) -> Any:
        return replace(await whole(*given, **options), drives_on=True)

    engine, robot = SimpleNamespace(on_client_lost="stop"), SimpleNamespace(drives_off_after_s=300.0)
    cell = SimpleNamespace(cell=SimpleNamespace(engine=engine, robot=robot, hooks=Hooks()))
    monkeypatch.setattr(engine_process, "carry_out", left_on)
    monkeypatch.setattr(engine_process, "load_cell", lambda _path: cell)
    async with serving(bench.root), engine_client(bench.root) as client:
        for _ in range(2):
            await client.request(Start(procedure="script"))
            await next_event(client, "prompt", id="door")
            async with connected(bench.root) as other:
                assert other.snapshot.drives is None
            await client.answer("door", "yes")
            await next_event(client, "drives", on=True)
        await client.request(Plain(op="shutdown"))


async def test_a_refused_start_restarts_the_drives_countdown(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    counts: list[str] = []
    monkeypatch.setattr(RestingDrives, "begin_again", lambda _self: counts.append("again"))
    monkeypatch.setattr(RestingDrives, "forget", lambda _self: counts.append("forgotten"))
    async with serving(bench.root), engine_client(bench.root) as client:
        with pytest.raises(RefusedError, match="no procedure 'unknown'"):
            await client.request(Start(procedure="unknown"))
        assert counts == ["again"]
        await client.request(Start(procedure="script"))
        await next_event(client, "prompt", id="door")
        await client.answer("door", "yes")
        await next_event(client, "idle")
        assert counts == ["again", "forgotten"]
        await client.request(Plain(op="shutdown"))


async def test_an_unplannable_run_is_refused_with_its_exit_code(bench: FakeBench) -> None:
    async with serving(bench.root), engine_client(bench.root) as client:
        with pytest.raises(RefusedError, match="no procedure 'unknown'") as refused:
            await client.request(Start(procedure="unknown"))
        assert refused.value.code == ExitCode.USAGE
        await client.request(Plain(op="shutdown"))


@pytest.mark.parametrize("kind", ["is a device", "is a pipe"])
async def test_a_cell_that_never_ends_is_refused(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch, kind: str
) -> None:
    monkeypatch.setattr(engine_process, "load_cell", load_cell)
    path = Path("/dev/zero")
    if kind == "is a pipe":
        path = bench.root.parent / "pipe.toml"
        os.mkfifo(path)
    async with serving(bench.root), engine_client(bench.root) as client:
        with pytest.raises(RefusedError, match=kind) as refused:
            await client.request(Start(procedure="script", cell=str(path)))
        assert refused.value.code == ExitCode.USAGE
        assert (await client.request(Plain(op="ping")))["ok"] is True
        await client.request(Plain(op="shutdown"))


async def test_after_an_abort_nothing_starts_until_it_is_cleared(bench: FakeBench) -> None:
    async with serving(bench.root), engine_client(bench.root) as client:
        with pytest.raises(RefusedError, match="nothing to clear"):
            await client.request(Plain(op="clear"))
        await client.request(Start(procedure="script"))
        await next_event(client, "prompt")
        with pytest.raises(RefusedError, match="for after an abort"):
            await client.request(Plain(op="clear"))
        await client.request(Plain(op="abort"))
        assert (await next_event(client, "run-ended"))["exit_code"] == ExitCode.INTERRUPTED
        await next_event(client, "idle")
        with pytest.raises(
            RefusedError, match=r"after the abort \(Ada .* clear the abort .*x on Run, F4"
        ) as refused:
            await client.request(Start(procedure="script"))
        assert refused.value.code == ExitCode.SAFETY
        await client.request(Plain(op="clear"))
        await next_event(client, "state", state="CLEARING")
        await next_event(client, "state", state="STOPPED")
        await client.request(Start(procedure="script"))
        await client.request(Plain(op="stop"))
        await next_event(client, "run-ended")
        await next_event(client, "idle")
        await client.request(Plain(op="shutdown"))


async def test_losing_a_client_follows_the_cells_policy(bench: FakeBench) -> None:
    async with serving(bench.root), engine_client(bench.root) as ben:
        await ben.release()
        async with engine_client(bench.root) as ada:
            await ada.request(Start(procedure="script"))
            await next_event(ben, "prompt")
        assert (await next_event(ben, "client-lost"))["policy"] == "stop"
        assert (await next_event(ben, "run-ended"))["status"] == "stopped"
        await next_event(ben, "idle")
        await ben.take_control()
        await ben.request(Plain(op="shutdown"))


async def test_losing_a_client_while_planning_follows_the_policy(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    planning, go_on, plan = threading.Event(), threading.Event(), vars(engine_process)["plan_run"]

    def slow(*arguments: Any) -> Any:
        planning.set()
        assert go_on.wait(5)
        return plan(*arguments)

    monkeypatch.setattr(engine_process, "plan_run", slow)
    async with serving(bench.root), engine_client(bench.root) as ben:
        await ben.release()
        async with engine_client(bench.root) as ada:
            asking = asyncio.create_task(ada.request(Start(procedure="script")))
            await asyncio.to_thread(planning.wait, 5)
        await cancel(asking)
        await next_event(ben, "control", what="left")
        go_on.set()
        assert (await next_event(ben, "client-lost"))["policy"] == "stop"
        assert (await next_event(ben, "run-ended"))["status"] == "stopped"
        await next_event(ben, "idle")
        await ben.take_control()
        await ben.request(Plain(op="shutdown"))
    assert "move" not in bench.robot.calls


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGTERM, ExitCode.TERMINATED), (signal.SIGINT, ExitCode.INTERRUPTED)]
)
async def test_an_idle_engine_ends_on_signals_but_outlives_its_terminal(
    bench: FakeBench, number: signal.Signals, code: ExitCode
) -> None:
    async with serving(bench.root) as engine:
        for harmless in (signal.SIGHUP, signal.SIGUSR1):
            os.kill(os.getpid(), harmless)
        await asyncio.sleep(0.01)
        assert not engine.done()
        os.kill(os.getpid(), number)
        assert await engine == code


async def test_a_termination_aborts_the_run_and_seals_its_record(bench: FakeBench) -> None:
    async with serving(bench.root) as engine, engine_client(bench.root) as client:
        await client.request(Start(procedure="script"))
        await next_event(client, "prompt")
        os.kill(os.getpid(), signal.SIGTERM)
        assert (await next_event(client, "run-ended"))["status"] == "aborted"
        assert await engine == ExitCode.TERMINATED


async def test_an_engine_that_nobody_comes_to_ends(bench: FakeBench) -> None:
    async with serving(bench.root, wait_for_client_s=0.0) as engine:
        assert await engine == ExitCode.TIMEOUT


async def test_one_run_for_whoever_attaches(bench: FakeBench) -> None:
    began: asyncio.Queue[str] = asyncio.Queue()
    engine = EngineProcess(Path("cell.toml"), bench.root)
    request = decode_request(b'{"v": 1, "id": 1, "op": "start", "procedure": "script"}')[1]
    assert isinstance(request, Start)

    def opened(path: Path) -> None:
        began.put_nowait(path.name)

    task = asyncio.create_task(engine.run_once(request, opened, lambda: began.put_nowait("ready")))
    name = await began.get()
    assert await began.get() == "ready"
    async with engine_client(bench.root / name) as client:
        if client.snapshot.prompt is None:
            await next_event(client, "prompt")
        await client.answer("door", "yes")
        assert (await next_event(client, "run-ended"))["status"] == "complete"
    assert (await task).path.name == name
    assert began.empty()


@pytest.mark.parametrize("op", ["stop", "abort"])
async def test_a_stop_while_planning_prevents_the_run(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch, op: str
) -> None:
    planning, go_on, plan = threading.Event(), threading.Event(), vars(engine_process)["plan_run"]

    def slow(*arguments: Any) -> Any:
        planning.set()
        assert go_on.wait(5)
        return plan(*arguments)

    monkeypatch.setattr(engine_process, "plan_run", slow)
    async with serving(bench.root), engine_client(bench.root) as ada:
        asking = asyncio.create_task(ada.request(Start(procedure="script")))
        await asyncio.to_thread(planning.wait, 5)
        async with connected(bench.root) as ben:
            await ben.request(request_of({"op": op}))
        with pytest.raises(
            RefusedError, match=r"Ada \(test-2\) (stopped|aborted) it before it began"
        ) as refused:
            await asking
        assert refused.value.code == ExitCode.INTERRUPTED
        go_on.set()
        with pytest.raises(RefusedError, match="no run is under way"):
            await ada.request(request_of({"op": op}))
        assert list(bench.root.iterdir()) == []
        # The next one begins as ever.
        await ada.request(Start(procedure="script"))
        await next_event(ada, "prompt")
        await ada.request(Plain(op="stop"))
        await next_event(ada, "idle")
        await ada.request(Plain(op="shutdown"))
    assert "move" not in bench.robot.calls


async def test_a_stop_during_record_creation_leaves_a_complete_record(
    bench: FakeBench, monkeypatch: pytest.MonkeyPatch
) -> None:
    making, go_on, create = asyncio.Event(), asyncio.Event(), RunStore.create

    async def slow(*arguments: Any, **options: Any) -> RunStore:
        making.set()
        await go_on.wait()
        return await create(*arguments, **options)

    monkeypatch.setattr(RunStore, "create", slow)
    async with serving(bench.root), engine_client(bench.root) as ada:
        asking = asyncio.create_task(ada.request(Start(procedure="script")))
        await making.wait()
        await ada.request(Plain(op="stop"))
        go_on.set()
        opened = await asking
        assert (await next_event(ada, "run-ended"))["status"] == "stopped"
        await next_event(ada, "idle", state="STOPPED")
        assert RunReader(Path(str(opened["path"]))).status == "stopped"
        await ada.request(Plain(op="shutdown"))
    assert "servo on" not in bench.robot.calls


async def test_nothing_begins_once_the_engine_ends(bench: FakeBench) -> None:
    async with serving(bench.root), engine_client(bench.root) as ada:
        # Both lines are there before the engine gets to its end.
        ending, starting = (
            asyncio.create_task(ada.request(request_of({"op": op, **fields})))
            for op, fields in (("shutdown", {}), ("start", {"procedure": "script"}))
        )
        assert await ending
        with pytest.raises(RefusedError, match="the engine ends"):
            await starting
    assert list(bench.root.iterdir()) == []
