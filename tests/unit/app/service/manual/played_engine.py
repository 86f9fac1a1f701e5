"""An engine with two clients whose arm and links are worked by hand."""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Any

import pytest

from catseye.app.guard import raw
from catseye.app.protocol.requests import JogHold, JogMode, JogStep, Raw, Send
from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.errors import RefusedError
from catseye.app.service.mailbox import Mailbox
from catseye.app.service.manual.manual_control import ManualControl
from catseye.app.service.member import Member
from catseye.drivers.roles.errors import LinkError
from tests.unit.app.guard.fakes import FakeGuard
from tests.unit.app.service.manual.benches import cell_from_template
from tests.unit.app.service.manual.timed_arm import ManualFixture, TimedArm
from tests.unit.drivers.virtual_time import VirtualClock, run


class Wire:
    """A link that answers every write in capitals."""

    def __init__(self) -> None:
        self.endpoint = "memory://wire"
        self.is_open = False
        self.open_error: LinkError | None = None
        self.stuck = False
        self.closing_s = 0.0
        self.sink: Any = None
        self._come: asyncio.Queue[bytes | LinkError] = asyncio.Queue()

    async def open(self) -> None:
        if self.open_error:
            raise self.open_error
        self.is_open = True

    async def close(self) -> None:
        await asyncio.sleep(self.closing_s)
        self.is_open = False

    async def write(self, data: bytes) -> None:
        self.sink("tx", data)
        if self.stuck:
            await asyncio.Event().wait()
        self._come.put_nowait(data.upper())

    async def read(self) -> bytes:
        came = await self._come.get()
        if isinstance(came, LinkError):
            raise came
        self.sink("rx", came)
        return came

    def breaks(self) -> None:
        self._come.put_nowait(LinkError("the other side has closed the link"))

    def waiting(self) -> bytes:
        return b""

    def send_urgent(self, data: bytes, *, cut: bytes = b"") -> None:
        del cut
        self.sink("tx", data)

    def note_heal(self, why: str) -> None:
        self.sink("heal", why.encode())

    def fileno(self) -> int:
        return -1


class Engine:
    """An engine with two clients, of which Ada holds control."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.fixture = ManualFixture(cell_from_template(), TimedArm())
        self.arm = self.fixture.arm
        self.registry = ClientRegistry(VirtualClock())
        self.busy: RefusedError | None = None
        self.aborts: list[str] = []
        self.manual = ManualControl(self.registry, self.fixture.bench, self._require_idle, self.aborts.append)
        self.ada, self.ben = (self.registry.join("test", who, Mailbox(), print) for who in ("Ada", "Ben"))
        self.registry.lease.take(self.ada, force=False)
        self.wire = Wire()
        self.guard = FakeGuard()
        monkeypatch.setattr(raw, "open_transport", self._opened)
        monkeypatch.setattr(raw, "ArmGuard", lambda _endpoint: self.guard)

    def jog(self, *, on: bool = True, who: Member | None = None) -> "asyncio.Future[Any]":
        return self.manual.jog(who or self.ada, JogMode(on=on))

    def step(self, by: float) -> "asyncio.Future[Any]":
        return self.manual.step(self.ada, JogStep(joint="j1", by=by))

    def hold(self, direction: int) -> Any:
        request = {"joint": "j1", "direction": direction}
        return self.manual.hold(JogHold.model_validate(request))

    def raw(self, device: str = "interferometer", **fields: Any) -> "asyncio.Future[Any]":
        return self.manual.raw(self.ada, Raw(device=device, **fields))

    def send(self, data: str, device: str = "interferometer") -> "asyncio.Future[Any]":
        return self.manual.send(Send(device=device, hex=data))

    def _require_idle(self) -> None:
        if self.busy:
            raise self.busy

    def _opened(self, endpoint: str, sink: Any) -> Wire:
        assert endpoint.startswith("memory://")
        self.wire.sink = sink
        return self.wire


Script = Callable[[Engine], Awaitable[None]]


def played(script: Script, monkeypatch: pytest.MonkeyPatch) -> Engine:
    """Play a script; whatever it leaves behind is ended as an engine does, and the arm stands."""

    async def work() -> Engine:
        engine = Engine(monkeypatch)
        await script(engine)
        await engine.manual.end("the engine ends")
        assert engine.manual.occupied is None
        assert not engine.arm.moving
        assert not engine.wire.is_open
        assert engine.fixture.detached_now == []
        assert not engine.fixture.acquired_now
        await asyncio.sleep(0.1)
        assert asyncio.all_tasks() == {asyncio.current_task()}
        return engine

    return run(work())
