"""The way to the engine: engines that are gone, deaf, or not the one that moves the arm."""

import asyncio
import signal
import socket
import subprocess
import sys
import tempfile
from collections.abc import AsyncIterator, Awaitable, Callable, Iterator
from contextlib import asynccontextmanager
from datetime import UTC, datetime
from pathlib import Path

import pytest

from catseye.app.protocol.requests import Start
from catseye.app.service.address import socket_folder, socket_name
from catseye.app.service.errors import RefusedError, ServiceError
from catseye.app.tui import link as link_module
from catseye.app.tui import stopping
from catseye.app.tui.engines import EngineProcess, find_engine
from catseye.app.tui.link import EngineLink
from tests.patience import HANG_S
from tests.unit.app.tui.fake_engine import FakeEngine
from tests.unit.app.tui.scripted import SNAPSHOT

RUN = "20261121T090000Z_open-loop_abc123"


class QuickClock:
    """A clock whose waits are short."""

    def now_utc(self) -> datetime:
        return datetime.now(UTC)

    def monotonic_s(self) -> float:
        return asyncio.get_running_loop().time()

    async def sleep(self, duration_s: float) -> None:
        await asyncio.sleep(duration_s / 1000.0)


@pytest.fixture
def root(monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """Return a folder of runs with one run in it; its sockets are of this test alone."""
    with tempfile.TemporaryDirectory(dir="/tmp") as folder:
        monkeypatch.setenv("XDG_RUNTIME_DIR", folder)
        monkeypatch.setattr(stopping, "ANSWER_S", 0.1)
        monkeypatch.setattr(link_module, "SILENT_S", 0.1)
        runs = Path(folder) / "runs"
        (runs / RUN).mkdir(parents=True)
        yield runs


Until = Callable[[Callable[[], bool]], Awaitable[None]]


@asynccontextmanager
async def serving(link: EngineLink) -> AsyncIterator[Until]:
    """Keep the connection; yield what waits until what the engine has sent fulfils a condition."""
    changed = asyncio.Event()

    async def until(condition: Callable[[], bool]) -> None:
        async with asyncio.timeout(HANG_S):
            while not condition():
                changed.clear()
                await changed.wait()

    task = asyncio.create_task(link.serve(changed.set))
    try:
        yield until
    finally:
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)


def leave_a_dead_socket(place: Path) -> Path:
    """Leave what a killed engine leaves."""
    path = socket_folder() / socket_name(place)
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(path))
    assert path.is_socket()
    return path


async def test_socket_of_a_killed_engine_is_no_engine(root: Path) -> None:
    leave_a_dead_socket(root / RUN)
    leave_a_dead_socket(root)
    assert find_engine(root) is None


async def test_another_processs_run_is_found_despite_an_idle_engine(root: Path) -> None:
    idle, other = FakeEngine(), FakeEngine(run=RUN, procedure="open-loop", title="Open loop", state="EXECUTE")
    link = EngineLink(root, None, QuickClock())
    async with idle.at(root), serving(link) as until:
        await until(lambda: link.engine.connected)
        async with other.at(root / RUN):
            await until(lambda: link.engine.running)
        await until(lambda: link.engine.connected and not link.engine.running)


async def test_stop_reaches_a_run_of_another_engine(root: Path) -> None:
    idle, other = FakeEngine(), FakeEngine(run=RUN, procedure="open-loop", title="Open loop", state="EXECUTE")
    idle.refusals["stop"] = "no run is under way"
    link = EngineLink(root, None, QuickClock())
    async with idle.at(root), serving(link) as until:
        await until(lambda: link.engine.connected)
        async with other.at(root / RUN):
            await link.stop("stop")
    assert "stop" in other.asked


async def test_stop_without_a_connection_makes_one(root: Path) -> None:
    engine = FakeEngine()
    async with engine.at(root):
        await EngineLink(root, None, QuickClock()).stop("abort")
    assert engine.asked == ["abort"]


async def test_stop_where_nothing_runs_is_refused(root: Path) -> None:
    engine = FakeEngine()
    engine.refusals["stop"] = "no run is under way"
    async with engine.at(root):
        with pytest.raises(RefusedError, match="no run is under way"):
            await EngineLink(root, None, QuickClock()).stop("stop")


async def test_stop_that_nobody_hears_names_the_emergency_stop(root: Path) -> None:
    with pytest.raises(ServiceError, match="emergency stop"):
        await EngineLink(root, None, QuickClock()).stop("stop")


async def test_deaf_engine_is_aborted_by_a_signal(root: Path) -> None:
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-c", "input()", stdin=asyncio.subprocess.PIPE
    )
    process.send_signal(signal.SIGSTOP)
    engine = FakeEngine(pid=process.pid)
    link = EngineLink(root, None, QuickClock())
    async with engine.at(root), serving(link) as until:
        await until(lambda: link.engine.connected)
        engine.deaf = True
        with pytest.raises(ServiceError, match="signal to abort"):
            await link.stop("stop")
    assert await process.wait() == -signal.SIGTERM


async def test_order_to_a_deaf_engine_ends_with_a_text(root: Path) -> None:
    engine = FakeEngine()
    link = EngineLink(root, None, QuickClock())
    async with engine.at(root), serving(link) as until:
        await until(lambda: link.engine.bench is not None)
        engine.deaf = True
        with pytest.raises(ServiceError, match="does not answer"):
            await link.request(Start(procedure="open-loop"))
        assert link.engine.silent_since_s is not None


async def test_deaf_engine_keeps_nobody_from_quitting(root: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(link_module, "_LEAVE_S", 0.1)
    engine = FakeEngine()
    link = EngineLink(root, None, QuickClock())
    async with engine.at(root), serving(link) as until:
        await until(lambda: link.engine.connected)
        engine.deaf = True
        async with asyncio.timeout(HANG_S):
            await link.leave(end_engine=True)


@pytest.mark.parametrize(("others", "ends"), [([], True), ([{"client": "tui-2", "who": "Ben"}], False)])
async def test_quitting_ends_an_engine_that_nobody_else_uses(
    root: Path, others: list[dict[str, str]], ends: bool
) -> None:
    engine = FakeEngine()
    link = EngineLink(root, None, QuickClock())
    # What the snapshot said is the state of things when this client came.
    async with engine.at(root), serving(link) as until:
        await until(lambda: link.engine.bench is not None)
        engine.publish(event="clients", clients=[*SNAPSHOT["clients"], {"client": "x-3", "who": "Eve"}])
        engine.publish(event="clients", clients=(now := [*SNAPSHOT["clients"], *others]))
        engine.publish(event="warning", text="published", data={})
        await until(lambda: bool(link.engine.log))
        assert [dict(client) for client in link.engine.clients] == now
        await link.leave(end_engine=True)
    assert ("shutdown" in engine.asked) == ends


async def test_engine_deaf_from_the_start_is_reported(root: Path) -> None:
    engine = FakeEngine()
    engine.deaf = True
    link = EngineLink(root, None, QuickClock())
    async with engine.at(root), serving(link) as until:
        await until(lambda: "does not answer" in link.engine.trouble)


async def test_engine_of_another_version_is_reported(root: Path) -> None:
    engine = FakeEngine()
    engine.refusals["hello"] = "version 2 is spoken here"
    link = EngineLink(root, None, QuickClock())
    async with engine.at(root), serving(link) as until:
        await until(lambda: link.engine.trouble == "version 2 is spoken here")


def test_process_that_has_ended_takes_no_signal() -> None:
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as child:
        process = EngineProcess(child.pid)
        child.kill()
        child.wait()
        assert not process.abort()
        process.forget()
