"""An engine's clients see the bench before, during and after a run, and when a device goes and comes back."""

import asyncio
import json
import subprocess
import time
from collections.abc import AsyncIterator, Callable, Iterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from catseye.app.engine.waiting import cancel
from catseye.app.protocol.requests import Plain, Start, Watch
from catseye.app.service.address import find_socket
from catseye.app.service.client import EngineClient, connect
from catseye.app.store.reader import RunReader
from tests.patience import HANG_S
from tests.system.command import Emulated, begun, emulated, own_runtime, start

SPEED = 40.0
_SMALL = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-60.0, -40.0, -20.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 60.0]",
}
_NAMES = ["robot", "interferometer", "environment", "tracker"]


@pytest.fixture
def bench(tmp_path: Path) -> Iterator[Emulated]:
    with own_runtime(), emulated(tmp_path, "--speed", f"{SPEED:g}", edit=_SMALL) as running:
        yield running


class Watcher:
    """A client that keeps what it received."""

    def __init__(self, client: EngineClient) -> None:
        self.client = client
        self.received: list[dict[str, Any]] = []
        self._task = asyncio.create_task(self._listen())
        self._news = asyncio.Event()

    async def _listen(self) -> None:
        async for event in self.client.events():
            self.received.append(event.json_object())
            self._news.set()

    async def until(
        self, seen: Callable[[dict[str, Any]], bool], event: str = "bench", ask: Plain | None = None
    ) -> dict[str, Any]:
        """Wait for the next event of which something is true; what is asked for may come before its answer."""
        count = len(self.received)
        if ask is not None:
            await self.client.request(ask)
        async with asyncio.timeout(HANG_S):
            while True:
                for message in self.received[count:]:
                    count += 1
                    if message["event"] == event and seen(message):
                        return message
                self._news.clear()
                await self._news.wait()

    async def next(self, event: str) -> dict[str, Any]:
        """Wait for the next event of a kind."""
        return await self.until(lambda message: bool(message), event)

    async def end(self) -> None:
        await cancel(self._task)

    def of(self, event: str) -> list[dict[str, Any]]:
        return [message for message in self.received if message["event"] == event]

    async def start(self, **more: Any) -> Path:
        """Start a measurement and return its directory."""
        fields: dict[str, Any] = {"search": "none", "speed": SPEED, "params": {"reflectors": ["P1"]}, **more}
        answer = await self.client.request(Start(procedure="open-loop", **fields))
        return Path(str(answer["path"]))


@asynccontextmanager
async def watching(socket: Path) -> AsyncIterator[Watcher]:
    async with connect(socket, "test", "Ada") as client:
        watcher = Watcher(client)
        answer: dict[str, Any] = await client.request(Watch(op="watch"))
        assert [device["name"] for device in answer["bench"]["devices"]] == _NAMES
        try:
            yield watcher
        finally:
            await watcher.end()


@asynccontextmanager
async def idle_engine(bench: Emulated) -> AsyncIterator[Watcher]:
    with begun("engine", "--cell", bench.cell, cwd=bench.cell.parent) as (process, output):
        line = await asyncio.to_thread(output.readline)
        async with watching(Path(json.loads(line)["socket"])) as watcher:
            await watcher.client.take_control()
            yield watcher
            await watcher.client.request(Plain(op="shutdown"))
        assert await asyncio.to_thread(process.wait, HANG_S) == 0


def links(bench: dict[str, Any]) -> set[str]:
    return {device["link"] for device in bench["devices"]}


def all_ok(bench: dict[str, Any]) -> bool:
    return links(bench) == {"ok"}


def idle(bench: dict[str, Any]) -> bool:
    return bench["run"] is None and all_ok(bench)


async def test_the_bench_is_seen_before_during_and_after_a_run(bench: Emulated) -> None:
    async with idle_engine(bench) as watcher:
        before = await watcher.until(idle)
        assert before["simulated"] is True
        assert before["robot"]["joints"][:2] == [0.0, 0.0]
        assert before["robot"]["age_s"] < 1.0
        assert before["air"]["refractive_index"] == pytest.approx(1.00027, abs=1e-5)
        # A run begins at once, and finds the links free.
        run = await watcher.start()
        during = await watcher.until(lambda seen: seen["run"] == run.name and all_ok(seen))
        assert during["simulated"] is True
        await watcher.next("step-done")
        await watcher.until(lambda seen: seen.get("state") == "HELD", "state", ask=Plain(op="hold"))
        held = [await watcher.next("bench") for _ in range(10)]
        # While it is held, somebody looks: a second for joints, a quarter for the beam, and what that takes.
        assert max(seen["robot"]["age_s"] for seen in held[5:]) < 2.0
        assert max(seen["beam"]["age_s"] for seen in held[5:]) < 1.0
        assert held[-1]["robot"]["joints"][:2] != [0.0, 0.0]
        await watcher.client.request(Plain(op="unhold"))
        ended = await watcher.next("run-ended")
        assert ended["status"] == "complete", ended
        after = await watcher.until(idle)
        assert after["robot"]["age_s"] < 1.0
    points = RunReader(run).rows("points")
    assert len(points) == 24 + 4
    samples = watcher.of("samples")
    assert sum(sum(event["count"]) for event in samples) > len(points)
    assert {event["missed"] for event in samples} == {0}
    # Five a second at most, over everything.
    assert len(watcher.of("bench")) == pytest.approx(len(samples), abs=2)


async def test_after_an_abort_the_bench_is_seen_again(bench: Emulated) -> None:
    async with idle_engine(bench) as watcher:
        await watcher.until(idle)
        run = await watcher.start()
        await watcher.until(lambda seen: seen["run"] == run.name and all_ok(seen))
        await watcher.until(bool, "run-ended", ask=Plain(op="abort"))
        assert (await watcher.until(idle))["robot"]["age_s"] < 1.0


async def test_an_unplugged_bench_is_lost_with_a_reason_and_reconnects(bench: Emulated) -> None:
    async with idle_engine(bench) as watcher:
        await watcher.until(idle)
        await watcher.client.request(Watch(op="traffic"))
        await watcher.until(lambda seen: "robot" in {line["device"] for line in seen["lines"]}, "wire")
        bench.process.kill()
        bench.process.wait(HANG_S)
        lost = await watcher.until(lambda seen: links(seen) == {"lost"})
        for device in lost["devices"]:
            assert device["error"]
            assert device["identity"]["simulated"] is True
        # What was seen last is still published, with its age.
        old = await watcher.until(lambda seen: seen["robot"]["age_s"] > 2.0)
        assert old["robot"]["joints"][:2] == [0.0, 0.0]
        again = start("emulate", bench.cell, cwd=bench.cell.parent)
        try:
            back = await watcher.until(idle)
            assert back["robot"]["age_s"] < old["robot"]["age_s"]
            assert {device["error"] for device in back["devices"]} == {None}
        finally:
            again.terminate()
            again.communicate(timeout=HANG_S)


async def test_the_run_of_a_command_is_seen_with_its_traffic(bench: Emulated) -> None:
    process = start(
        "run",
        "open-loop",
        "--cell",
        bench.cell,
        "--search",
        "none",
        "--speed",
        f"{SPEED:g}",
        "--param",
        'reflectors=["P1"]',
        "--json",
        cwd=bench.cell.parent,
    )  # fmt: skip - a command line
    drain = asyncio.create_task(asyncio.to_thread(process.communicate))
    try:
        run, socket = await asyncio.to_thread(_open_run, bench.cell.parent)
        async with watching(socket) as watcher:
            await watcher.client.request(Watch(op="traffic"))
            await watcher.until(all_ok)
            ended = await watcher.next("run-ended")
            assert ended["status"] == "complete"
        assert await _code(process, drain) == 0
    finally:
        process.kill()
        await drain
    stored = {
        (line["device"], line["direction"], line["hex"])
        for line in map(json.loads, (run / "wire.log").read_text().splitlines())
    }
    lines = [line for event in watcher.of("wire") for line in event["lines"]]
    assert {line["device"] for line in lines} >= {"robot", "interferometer", "environment"}
    assert {(line["device"], line["dir"], line["hex"]) for line in lines if "bytes" not in line} <= stored


def _open_run(folder: Path) -> tuple[Path, Path]:
    """Wait until a measurement is open; return its directory and socket."""
    end_s = time.monotonic() + HANG_S
    while time.monotonic() < end_s:
        for run in (folder / "catseye-runs").glob("*_open-loop_*"):
            if (socket := find_socket(run)) is not None:
                return run, socket
        time.sleep(0.01)
    raise AssertionError("no run was opened")


async def _code(process: "subprocess.Popen[str]", drain: "asyncio.Task[Any]") -> int | None:
    await drain
    return process.returncode


async def test_every_value_of_an_instrument_that_streams_is_seen(tmp_path: Path) -> None:
    edit = {'driver = "line-counter"\n': 'driver = "umd"\n', 'profile = "default"\n': ""}
    with own_runtime(), emulated(tmp_path, "--speed", "1", edit=edit) as bench:
        async with idle_engine(bench) as watcher:
            await watcher.until(idle)
            first = await watcher.next("samples")
            second = await watcher.until(lambda _: len(watcher.of("samples")) > 15, "samples")
    sampled = watcher.of("samples")
    counts = [
        count for event in sampled[sampled.index(first) : sampled.index(second)] for count in event["count"]
    ]
    # The emulated display sends 610 a second; asked for they would be ten.
    assert sum(counts) / (0.02 * len(counts)) > 300.0
