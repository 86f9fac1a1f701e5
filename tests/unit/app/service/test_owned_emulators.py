"""The emulated bench of an engine: started once, said to everybody, ended with the engine."""

import asyncio
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import pytest

from catseye.app.errors import LinkFailedError
from catseye.app.protocol.events import AnyEvent
from catseye.app.service import owned_emulators
from catseye.app.service.errors import RefusedError
from catseye.app.service.owned_emulators import OwnedEmulators
from tests.patience import until


class Emulators:
    """Stands for the processes of emulators."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.started: list[float] = []
        self.ended = 0
        self.dies = asyncio.Event()
        self.fault = ""
        self.announced: list[AnyEvent] = []
        self.changes: list[bool] = []
        monkeypatch.setattr(owned_emulators, "emulator_process", self._process)
        self.owned = OwnedEmulators(Path("cell.toml"), self.announced.append, self._changed)

    def _changed(self) -> None:
        self.changes.append(self.owned.speed is not None)

    async def wait(self) -> int:
        await self.dies.wait()
        return -9

    @property
    def process(self) -> Any:
        return self

    @asynccontextmanager
    async def _process(self, _cell: Path, speed: float, _seed: int, _truth: None) -> AsyncIterator[Any]:
        self.started.append(speed)
        if self.fault:
            raise LinkFailedError(self.fault)
        try:
            yield self
        finally:
            self.ended += 1


async def test_it_is_started_once_and_ends_with_the_engine(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Emulators(monkeypatch)
    await bench.owned.begin(20.0)
    await bench.owned.begin(20.0)
    assert bench.started == [20.0]
    assert bench.owned.speed == 20.0
    await bench.owned.end()
    assert bench.ended == 1
    assert bench.owned.speed is None


async def test_another_speed_is_refused_while_they_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Emulators(monkeypatch)
    await bench.owned.begin(400.0)
    with pytest.raises(RefusedError, match="runs at 400 times real speed"):
        bench.owned.begin(1.0)
    await bench.owned.end()


async def test_one_that_dies_is_said_and_can_be_started_again(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Emulators(monkeypatch)
    await bench.owned.begin(1.0)
    bench.dies.set()
    await until(lambda: bench.changes == [True, False])
    (event,) = bench.announced
    assert "ended with code -9: start it again (F10)" in str(event.json_object()["text"])
    bench.dies.clear()
    await bench.owned.begin(2.0)
    assert bench.started == [1.0, 2.0]
    await bench.owned.end()


async def test_one_that_does_not_start_says_why(monkeypatch: pytest.MonkeyPatch) -> None:
    bench = Emulators(monkeypatch)
    bench.fault = "the port is taken"
    with pytest.raises(RefusedError, match="the port is taken"):
        await bench.owned.begin(1.0)
    await until(lambda: bench.changes == [False])
    bench.fault = ""
    await bench.owned.begin(1.0)
    assert bench.owned.speed == 1.0
    await bench.owned.end()
