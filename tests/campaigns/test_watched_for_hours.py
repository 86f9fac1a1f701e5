"""A bench that is watched for hours, its devices pulled now and then, its client not reading: memory stays flat.

In virtual time, with devices in memory; CATSEYE_WATCHED_H sets the hours.
"""

import asyncio
import gc
import os
import tracemalloc
from pathlib import Path

import pytest

from catseye.app.service.client_registry import ClientRegistry
from catseye.app.service.mailbox import Mailbox
from catseye.app.service.watching.bench_facts import facts_of
from catseye.app.service.watching.device_pool import DevicePool
from catseye.app.service.watching.telemetry import Telemetry
from catseye.app.service.watching.traffic import MOST_LINES
from tests.unit.app.service.manual.benches import bench_from_template, cell_from_template
from tests.unit.app.service.watching.pulled_devices import PulledCell, disk, lost
from tests.unit.drivers.virtual_time import VirtualClock, run

HOURS = float(os.environ.get("CATSEYE_WATCHED_H", "1"))
LIMIT_BYTES = 64 * 1024


def _held_bytes() -> int:
    gc.collect()
    return tracemalloc.get_traced_memory()[0]


async def _watched(folder: Path) -> tuple[int, int]:
    """Return what is held when a tenth of the time is over, and at its end, bytes."""
    registry, cell, clock = ClientRegistry(VirtualClock()), PulledCell(), VirtualClock()
    telemetry = Telemetry(registry, clock, folder, disk)
    telemetry.describe(facts_of(cell_from_template(), bench_from_template()))
    bench = DevicePool(lambda: cell.made(telemetry.latest), telemetry.latest, clock, print)
    telemetry.on_watched = bench.watched
    member = registry.join("test", "Ada", Mailbox(), lambda _reason: None)
    registry.listen(member, "watch", on=True)
    registry.listen(member, "traffic", on=True)
    telemetry.wake()
    early_bytes = 0
    for tenth in range(10):
        for _ in range(6):
            await asyncio.sleep(HOURS * 60.0 - 30.0)
            cell.counter.error = lost()
            await asyncio.sleep(20.0)
            cell.counter.error = None
            await asyncio.sleep(10.0)
            for _ in range(MOST_LINES):
                telemetry.traffic.record("robot", "tx", bytes(100))
            for device in cell.everyone():
                # What the devices of the test remember is no memory of the program.
                device.log.clear()
                device.times_s.clear()
        if tenth == 0:
            early_bytes = _held_bytes()
    assert len(member.mailbox) == 3
    late_bytes = _held_bytes()
    await telemetry.end()
    await bench.end()
    return early_bytes, late_bytes


@pytest.mark.timeout(1800)
def test_memory_is_flat(tmp_path: Path) -> None:
    tracemalloc.start()
    try:
        early_bytes, late_bytes = run(_watched(tmp_path))
    finally:
        tracemalloc.stop()
    print(f"\nheld after {HOURS / 10:g} h {early_bytes} bytes, after {HOURS:g} h {late_bytes} bytes")  # noqa: T201  # the figure
    assert late_bytes - early_bytes <= LIMIT_BYTES
