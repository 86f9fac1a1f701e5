"""The context of a procedure on scripted instruments and a real store."""

from collections.abc import AsyncIterator
from pathlib import Path

import pytest

from catseye.app.engine.announcer import Announcer
from catseye.app.engine.context import RunContext
from catseye.app.engine.control import RunControl
from catseye.app.engine.devices import Devices
from catseye.app.engine.gate import MotionGate
from catseye.app.engine.operator import Operator
from catseye.app.store.reader import RunReader
from catseye.app.store.run_store import RunStore
from catseye.procedures.kit.recording import Recorded
from catseye.procedures.scara.records import Distance
from tests.unit.app.engine.fakes import ARM, FakeBench, free_way, straight
from tests.unit.app.engine.given_parts import READY, Parts, Willing


@pytest.fixture
async def parts(tmp_path: Path) -> AsyncIterator[Parts]:
    bench = FakeBench(tmp_path)
    store = await RunStore.create(
        tmp_path, "script", {}, bench.clock, records=[Distance, Recorded], reserve_bytes=0
    )
    control = RunControl(bench.clock, lambda _state, _reason: None)
    control.attach(bench.robot)
    control.starting()
    control.started()
    bench.robot.state = READY
    announcer = Announcer(store.path.name, bench.clock, bench.publish, lambda _error: None)
    devices = Devices(bench.robot, bench.counter, bench.air)
    gate = MotionGate(bench.robot, ARM.axes, free_way, 20.0)
    operator = Operator(bench.clock, {}, None, simulated=True, hands=Willing("tcp://127.0.0.1:1"))
    ctx = RunContext(
        devices,
        store,
        control,
        bench.clock,
        ARM.axes,
        gate,
        operator,
        announcer,
        straight,
        records=[Distance, Recorded],
    )
    yield Parts(bench, ctx, control, RunReader(store.path))
    await control.halted()
    await store.abandon()
