"""A registry with a run on a scripted robot, and clients over socket pairs."""

import asyncio
import json
import socket
from collections.abc import AsyncIterator, Mapping
from contextlib import AsyncExitStack, asynccontextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, cast

from catseye.app.engine.control import RunControl
from catseye.app.engine.gate import MotionGate
from catseye.app.engine.halt import HaltLimits
from catseye.app.engine.handle import RunHandle
from catseye.app.protocol.events import event_of
from catseye.app.protocol.message import MAX_LINE_BYTES, JsonObject
from catseye.app.protocol.run_events import RunEvent
from catseye.app.protocol.state import ControlState
from catseye.app.service.client import EngineClient, over
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.server import Server
from catseye.procedures.kit.records import Json
from tests.patience import HANG_S
from tests.unit.app.engine.fakes import ARM, FakeRobot, ManualClock, free_way

Streams = tuple[asyncio.StreamReader, asyncio.StreamWriter]


@dataclass
class RawClient:
    """Writes and reads lines as they are."""

    streams: Streams

    def write(self, line: bytes) -> None:
        self.streams[1].write(line)

    def send(self, op: str, number: int | str = 1, **fields: Json) -> None:
        self.write(json.dumps({"v": 1, "id": number, "op": op, **fields}).encode() + b"\n")

    async def read(self) -> dict[str, Any]:
        line = await self.streams[0].readline()
        assert line, "the engine closed the connection"
        message: dict[str, Any] = json.loads(line)
        return message

    async def ask(self, op: str, **fields: Json) -> dict[str, Any]:
        """Put a request and return its answer; events before it are passed over."""
        self.send(op, "asked", **fields)
        while True:
            message = await self.read()
            if message.get("re") == "asked":
                return message

    async def rest(self) -> list[dict[str, Any]]:
        """Return everything up to the end of the connection."""
        return [json.loads(line) for line in (await self.streams[0].read()).splitlines()]


@dataclass
class ServiceBench:
    """Everything but a procedure."""

    clock: ManualClock = field(default_factory=ManualClock)
    notes: list[tuple[str, dict[str, Json]]] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.registry = ClientRegistry(self.clock)
        self.server = Server(self.registry, self.clock)
        self.robot = FakeRobot(self.clock)
        self.robot.state = replace(self.robot.state, servo_on=True, override_percent=20.0)
        self.control = RunControl(self.clock, self._state_changed, HaltLimits(standstill_s=0.5))
        self.control.attach(self.robot)
        self.gate = MotionGate(self.robot, ARM.axes, free_way, 20.0)
        self.handle = RunHandle(
            Path("run-1"),
            "script",
            "Scripted",
            self.control,
            self._note,
            self.warnings.append,
            True,
            self.gate,
        )

    @asynccontextmanager
    async def running(self, state: ControlState = ControlState.EXECUTE) -> AsyncIterator["ServiceBench"]:
        """Serve a run in a state."""
        with self.registry.running(self.handle):
            self.control.starting()
            if state == ControlState.EXECUTE:
                self.control.started()
            try:
                yield self
            finally:
                await self.control.halted()
                await self.server.end()

    def state(self) -> str:
        return self.control.state

    def publish(self, event: str, **fields: Json) -> None:
        found = event_of({"t": "now", "event": event, "run": "run-1", **fields})
        self.registry.publish(cast(RunEvent, found))

    def noted(self, kind: str) -> list[dict[str, Json]]:
        return [data for noted, data in self.notes if noted == kind]

    async def raw(self, *, buffer_bytes: int | None = None) -> RawClient:
        """Connect without saying hello; the caller closes, or the server's end does."""
        near, far = await self._pair(buffer_bytes)
        self.server.accept(*near)
        return RawClient(far)

    @asynccontextmanager
    async def client(self, who: str = "Ada") -> AsyncIterator[EngineClient]:
        near, far = await self._pair(None)
        self.server.accept(*near)
        async with over(far, "test", who, self.clock) as client:
            yield client

    @asynccontextmanager
    async def clients(self, *names: str) -> AsyncIterator[list[EngineClient]]:
        async with AsyncExitStack() as stack:
            yield [await stack.enter_async_context(self.client(name)) for name in names]

    async def _pair(self, buffer_bytes: int | None) -> tuple[Streams, Streams]:
        near, far = socket.socketpair()
        if buffer_bytes is not None:
            near.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, buffer_bytes)
        return (
            await asyncio.open_unix_connection(sock=near, limit=MAX_LINE_BYTES),
            await asyncio.open_unix_connection(sock=far, limit=4096 if buffer_bytes else 2**24),
        )

    def _note(self, kind: str, data: Mapping[str, Json]) -> None:
        self.notes.append((kind, dict(data)))

    def _state_changed(self, state: ControlState, reason: str) -> None:
        self.publish("state", state=state, reason=reason)


async def next_event(client: EngineClient, event: str, **fields: Json) -> JsonObject:
    """Wait for an event with these fields; return it as it is on the wire."""
    async with asyncio.timeout(HANG_S):
        async for found in client.events():
            message = found.json_object()
            if found.event == event and all(message.get(key) == value for key, value in fields.items()):
                return message
    raise AssertionError(f"the connection ended without {event}")


async def settled(turns: int = 200) -> None:
    """Let everything that is under way come to rest."""
    for _ in range(turns):
        await asyncio.sleep(0)


def close(*clients: RawClient) -> None:
    for client in clients:
        client.streams[1].transport.abort()
