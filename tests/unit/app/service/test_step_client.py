"""A client that makes a step by hand gives signs of life until the arm stands."""

import asyncio
import json
import socket
from typing import Any

import pytest

from catseye.app.protocol.requests import JogStep
from catseye.app.service.client import STEP_PING_S, over
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.errors import RefusedError
from tests.patience import HANG_S
from tests.unit.app.engine.fakes import ManualClock

SNAPSHOT = ClientRegistry(ManualClock()).snapshot().json_object()


class Counting(ManualClock):
    """Notes how long it was slept for."""

    def __init__(self) -> None:
        super().__init__()
        self.slept_s: list[float] = []

    async def sleep(self, duration_s: float) -> None:
        self.slept_s.append(duration_s)
        await super().sleep(duration_s)


async def engine(stream: asyncio.StreamReader, out: asyncio.StreamWriter, last: dict[str, Any]) -> list[str]:
    """Answer everything at once but the step, which three signs of life come before; return what was asked."""
    asked: list[str] = []
    step: int | None = None
    while line := await stream.readline():
        request = json.loads(line)
        asked.append(request["op"])
        if request["op"] == "jog-step":
            step = request["id"]
        else:
            out.write(
                json.dumps({"v": 1, "re": request["id"], "ok": True, "snapshot": SNAPSHOT}).encode() + b"\n"
            )
        if step is not None and asked[-3:] == ["ping"] * 3:
            out.write(json.dumps({"v": 1, "re": step, **last}).encode() + b"\n")
            step = None
    return asked


@pytest.mark.parametrize("refused", [False, True])
async def test_signs_of_life_from_the_request_to_the_answer(refused: bool) -> None:
    near, far = socket.socketpair()
    mine = await asyncio.open_unix_connection(sock=near)
    theirs = await asyncio.open_unix_connection(sock=far)
    last = {"ok": False, "error": "stopped"} if refused else {"ok": True, "joints": [1.0, 2.0, 3.0, 4.0]}
    playing = asyncio.create_task(engine(*theirs, last))
    clock = Counting()
    async with asyncio.timeout(HANG_S), over(mine, "test", "Ada", clock) as client:
        if refused:
            with pytest.raises(RefusedError, match="stopped"):
                await client.jog_step(JogStep(joint="j1", by=1.0))
        else:
            assert (await client.jog_step(JogStep(joint="j1", by=1.0))).joints == (1.0, 2.0, 3.0, 4.0)
        told = len(clock.slept_s)
        await asyncio.sleep(0.01)
        # After the answer nothing pings that often any more.
        assert len(clock.slept_s) == told
    asked = await playing
    assert asked[:2] == ["hello", "jog-step"]
    assert asked.count("ping") >= 3
    assert STEP_PING_S in clock.slept_s
    theirs[1].close()
    await theirs[1].wait_closed()


async def test_what_came_while_the_program_stood_still_is_read_before_it_writes() -> None:
    near, far = socket.socketpair()
    far.setblocking(False)
    clock = ManualClock()
    mine = await asyncio.open_unix_connection(sock=near)
    loop = asyncio.get_running_loop()

    async def greet() -> None:
        request = json.loads(await loop.sock_recv(far, 4096))
        await loop.sock_sendall(
            far, json.dumps({"v": 1, "re": request["id"], "ok": True, "snapshot": SNAPSHOT}).encode() + b"\n"
        )

    greeting = asyncio.create_task(greet())
    async with asyncio.timeout(HANG_S), over(mine, "test", "Ada", clock) as client:
        await greeting
        # The sign of life begins to wait.
        await asyncio.sleep(0.01)
        # The engine ends while this program stands still; the next sign of life is due when it goes on.
        far.send(b'{"v": 1, "event": "idle", "state": "COMPLETE"}\n')
        far.close()
        clock.advance(2.5)
        assert [event.event async for event in client.events()] == ["idle"]
        assert client.closed == "the engine closed the connection"
