"""A folder of runs that ended in every way, with names that do not change."""

from pathlib import Path

from catseye.app.store.lock import RunLock
from catseye.app.store.run_store import RunStore
from catseye.app.store.seal import DATABASE
from catseye.procedures.kit.records import Json, Row
from tests.unit.app.store.fakes import RECORDS, TickingClock

POINT: Row = {
    "reflector": "P1",
    "segment": 0,
    "theta1_deg": 10.0,
    "theta2_deg": 20.0,
    "j3_mm": 100.0,
    "j4_deg": 30.0,
    "reported1_deg": 10.0,
    "reported2_deg": 20.0,
    "reported3_mm": 100.0,
    "reported4_deg": 30.0,
    "direction1": 1,
    "direction2": 1,
    "displacement_mm": 0.0,
    "spread_mm": 0.0,
    "readings": 10,
    "signal": 0.9,
    "time_utc": "2026-01-02T00:00:03+00:00",
    "duration_s": 0.5,
}

COMPLETE = "20261119T081500Z_open-loop_aaaaaa"
STOPPED = "20261120T093000Z_open-loop_bbbbbb"
DIED = "20261120T140000Z_validation-path_cccccc"
REAL = "20261121T070000Z_open-loop_dddddd"
DAMAGED = "20261121T073000Z_warmup_eeeeee"
RUNNING = "20261121T080000Z_reflector-search_ffffff"


async def make_runs(root: Path) -> RunLock:
    """Make one run of each state; return what keeps one of them under way."""
    await _store(root, COMPLETE, "complete", simulated=True, points=3)
    await _store(root, STOPPED, "stopped", simulated=True, points=2)
    await _store(root, DIED, "", simulated=True)
    await _store(root, REAL, "aborted", simulated=False, points=1)
    await _store(root, RUNNING, "", simulated=True)
    (root / DAMAGED).mkdir()
    (root / DAMAGED / DATABASE).write_bytes(b"no database, but long enough to look like one")
    return RunLock(root / RUNNING)


async def _store(root: Path, name: str, status: str, *, simulated: bool, points: int = 0) -> None:
    """Make a run; one with an empty status has no end."""
    meta: dict[str, Json] = {"cell": "lab-1", "simulated": simulated}
    store = await RunStore.create(
        root, name.split("_")[1], meta, TickingClock(), records=RECORDS, reserve_bytes=0
    )
    for number in range(points):
        await store.append_step(f"measure/{number}", 1, "a point", {}, [("points", POINT)])
    if status:
        await store.finish(status, 0 if status == "complete" else 5)
    else:
        await store.abandon()
    store.path.rename(root / name)
