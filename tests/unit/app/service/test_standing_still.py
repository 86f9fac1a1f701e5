"""A client reads what came while its program stood still before it writes."""

import asyncio
import json
import socket

from catseye.app.service.client import over
from catseye.app.service.client_registry import ClientRegistry
from tests.patience import HANG_S
from tests.unit.app.engine.fakes import ManualClock

SNAPSHOT = ClientRegistry(ManualClock()).snapshot().json_object()


async def test_events_received_while_suspended_are_read_before_writing() -> None:
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
