"""An engine that answers, refuses or is silent as a test says, at a real socket."""

import asyncio
import json
import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

from catseye.app.service.address import socket_folder, socket_name
from catseye.simulators.ports.tcp import close_server
from tests.unit.app.tui.scripted import SNAPSHOT
from tests.unit.app.tui.scripted_bench import BENCH


class FakeEngine:
    """Serves clients.

    Attributes:
        asked: requests of all clients, in order.
        refusals: text by request.
        deaf: lines are read and never answered.
        snapshot: that clients are met with.
    """

    def __init__(self, **snapshot: Any) -> None:
        self.asked: list[str] = []
        self.refusals: dict[str, str] = {}
        self.deaf = False
        self.snapshot = {**SNAPSHOT, "pid": os.getpid(), **snapshot}
        self._writers: list[asyncio.StreamWriter] = []
        self._served: list[Any] = []

    @asynccontextmanager
    async def at(self, place: Path) -> AsyncIterator[None]:
        """Listen at the socket of a run's directory, or of a folder of runs."""
        server = await asyncio.start_unix_server(self._serve, socket_folder() / socket_name(place))
        try:
            yield
        finally:
            await close_server(server)
            for writer in self._writers:
                writer.transport.abort()
            await asyncio.gather(*self._served, return_exceptions=True)

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        self._writers.append(writer)
        self._served.append(asyncio.current_task())
        try:
            while line := await reader.readline():
                request = json.loads(line)
                self.asked.append(request["op"])
                if not self.deaf:
                    answer = {"v": 1, "re": request["id"], **self._answer(request["op"])}
                    writer.write(json.dumps(answer).encode() + b"\n")
        finally:
            # Streams keep their socket when the other side ends, and a client that only looks does that at once.
            writer.transport.abort()

    def _answer(self, op: str) -> dict[str, Any]:
        if op in self.refusals:
            return {"ok": False, "error": self.refusals[op], "exit_code": 2}
        return {"ok": True, "snapshot": self.snapshot, "bench": BENCH}

    def publish(self, **event: Any) -> None:
        """Publish an event to all clients."""
        for writer in self._writers:
            writer.write(json.dumps({"v": 1, "t": "", "run": None, **event}).encode() + b"\n")
