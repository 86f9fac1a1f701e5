"""Many clients, idle ones and hostile ones shut nobody out."""

import asyncio
import errno
import gc
import json
import logging
import socket
from contextlib import suppress
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from catseye.app.protocol.requests import Plain
from catseye.app.service.address import listening
from catseye.app.service.client_registry import MOST_CLIENTS
from catseye.app.service.errors import RefusedError
from catseye.app.service.server import MOST_STRANGERS, Server
from catseye.app.service.session import Patience
from catseye.app.service.sparse_log import EVERY_S, SparseLog
from tests.unit.app.engine.fakes import ManualClock
from tests.unit.app.service.benches import ServiceBench, close, settled


async def test_one_client_too_many_is_refused_and_let_go() -> None:
    names = [f"client {number}" for number in range(MOST_CLIENTS)]
    async with ServiceBench().running() as bench, bench.clients(*names) as clients:
        late = await bench.raw()
        answer = await late.ask("hello", client="test", who="Late")
        assert (answer["ok"], "32 clients are connected" in answer["error"]) == (False, True)
        assert await late.rest() == []
        for client in clients:
            assert (await client.request(Plain(op="ping")))["ok"] is True
        close(late)


async def test_a_place_that_is_left_is_free_again() -> None:
    names = [f"client {number}" for number in range(MOST_CLIENTS - 1)]
    async with ServiceBench().running() as bench, bench.clients(*names):
        for who in ("Ada", "Ben"):
            async with bench.client(who) as client:
                assert len(client.snapshot.clients) == MOST_CLIENTS
            await settled()


async def test_the_arm_is_stopped_however_many_are_there() -> None:
    names = [f"client {number}" for number in range(MOST_CLIENTS)]
    async with ServiceBench().running() as bench, bench.clients(*names):
        idle = [await bench.raw() for _ in range(MOST_STRANGERS)]
        stopping = await bench.raw()
        assert (await stopping.ask("stop"))["ok"] is True
        close(stopping, *idle)


async def test_a_client_without_hello_is_let_go_after_two_seconds() -> None:
    async with ServiceBench().running() as bench, bench.client() as client:
        idle = await bench.raw()
        await settled()
        bench.clock.advance(1.9)
        assert (await idle.ask("ping"))["ok"] is True
        bench.clock.advance(0.2)
        [refusal] = await idle.rest()
        assert "no hello within 2 s" in refusal["error"]
        assert (await client.request(Plain(op="ping")))["ok"] is True
        close(idle)


async def test_idle_connections_make_room_for_those_that_speak() -> None:
    async with ServiceBench().running() as bench, bench.client() as client:
        idle = [await bench.raw() for _ in range(3 * MOST_STRANGERS)]
        async with bench.client("Ben") as ben:
            assert (await ben.request(Plain(op="ping")))["ok"] is True
        assert (await client.request(Plain(op="ping")))["ok"] is True
        [refusal] = await idle[0].rest()
        assert "wait without hello" in refusal["error"]
        close(*idle)


async def test_shutdown_takes_hello_and_control() -> None:
    ended: list[str] = []
    bench = ServiceBench()
    engine: Any = SimpleNamespace(shut_down=ended.append)
    bench.server = Server(bench.registry, bench.clock, engine)
    async with bench.running(), bench.client() as client:
        stranger = await bench.raw()
        assert "hello first" in (await stranger.ask("shutdown"))["error"]
        with pytest.raises(RefusedError, match="which nobody holds: take control first"):
            await client.request(Plain(op="shutdown"))
        assert ended == []
        await client.take_control()
        await client.request(Plain(op="shutdown"))
        assert len(ended) == 1
        close(stranger)


@pytest.mark.parametrize("deep", ["[" * 60_000, '{"v": 1, "a": ' + "[" * 20_000 + "]" * 20_000 + "}"])
async def test_a_message_that_is_nested_too_deeply_is_refused(deep: str) -> None:
    async with ServiceBench().running() as bench:
        client = await bench.raw()
        client.write(deep.encode() + b"\n")
        assert "not JSON" in (await client.read())["error"]
        assert (await client.ask("ping"))["ok"] is True
        close(client)


async def test_clients_come_in_through_the_socket(tmp_path: Path, runtime: Path) -> None:
    bench = ServiceBench()
    server = Server(bench.registry, bench.clock, patience=Patience(flush_s=0.1))
    async with server.at(tmp_path):
        [path] = (runtime / "catseye").glob("*.sock")
        crowd = [await asyncio.open_unix_connection(path) for _ in range(100)]
        reader, writer = await asyncio.open_unix_connection(path)
        writer.write(b'{"v": 1, "id": 1, "op": "ping"}\n')
        assert json.loads(await reader.readline())["ok"] is True
        for _, each in [*crowd, (reader, writer)]:
            each.transport.abort()
        await server.end()


@pytest.mark.usefixtures("runtime")
@pytest.mark.parametrize("turns", range(12))
@pytest.mark.parametrize("ends_first", [True, False])
async def test_a_client_that_comes_at_the_end_is_let_go(
    tmp_path: Path, recwarn: pytest.WarningsRecorder, turns: int, ends_first: bool
) -> None:
    """Whatever turn of the loop the end meets it in."""
    bench = ServiceBench()
    server = Server(bench.registry, bench.clock)
    with listening(tmp_path) as listener, socket.socket(socket.AF_UNIX) as client:
        client.settimeout(5.0)
        async with server.on(listener):
            await asyncio.sleep(0)
            client.connect(listener.getsockname())
            for _ in range(turns):
                await asyncio.sleep(0)
            if ends_first:
                await server.end()
        if not ends_first:
            await server.end()
        listener.close()
        # One that nobody had taken yet is refused by the system.
        with suppress(ConnectionResetError):
            assert await asyncio.to_thread(client.recv, 1) == b""
    gc.collect()
    assert [str(warning.message) for warning in recwarn] == []
    assert asyncio.all_tasks() == {asyncio.current_task()}


@pytest.mark.usefixtures("runtime")
async def test_what_the_system_refuses_is_logged_now_and_then(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    bench, tries = ServiceBench(), 0
    begun_s = bench.clock.monotonic_s()

    def no_room(_listener: socket.socket) -> None:
        nonlocal tries
        tries += 1
        bench.clock.advance(1.0)
        raise OSError(errno.EMFILE, "too many open files")

    monkeypatch.setattr(socket.socket, "accept", no_room)
    with listening(tmp_path) as listener, socket.socket(socket.AF_UNIX) as client:
        client.connect(listener.getsockname())
        async with Server(bench.registry, bench.clock).on(listener):
            while tries < 50:
                await asyncio.sleep(0)
                bench.clock.advance(1.0)
    assert len(caplog.records) < tries
    assert 1 <= len(caplog.records) <= (bench.clock.monotonic_s() - begun_s) / EVERY_S + 1


def test_errors_between_two_lines_are_counted(caplog: pytest.LogCaptureFixture) -> None:
    clock = ManualClock()
    log = SparseLog(logging.getLogger("test"), clock)
    for _ in range(1000):
        log.error("it failed", ValueError("why"))
    clock.advance(EVERY_S)
    log.error("it failed", ValueError("why"))
    assert [record.getMessage() for record in caplog.records] == [
        "it failed",
        "it failed (999 more errors were not logged)",
    ]
