"""A stored warm-up of forty minutes, by which a stage of the day is done."""

from collections.abc import Mapping
from pathlib import Path

from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.clock import Clock
from catseye.procedures.kit.records import Json


async def stored_warm_up(
    root: Path, clock: Clock, drift: float | None, *, warm: bool, meta: Mapping[str, Json] | None = None
) -> Path:
    """Store a warm-up that ended with a drift in µm, u = 1 µm, and return its folder."""
    params: Json = {"window_min": 10.0, "limit_um_per_10min": 20.0}
    store = await RunStore.create(root, "warmup", {**(meta or {}), "params": params}, clock, reserve_bytes=0)
    visit: dict[str, Json] = {"measured": True, "segment": 0, "displacement_mm": 0.0, "clock_s": 0.0}
    await store.append_step("visit/0000", 1, "visit", visit, [])
    end: dict[str, Json] = {
        "elapsed_min": 40.0,
        "limit_um_per_10min": 20.0,
        "warm": warm,
        "reflector": "P1",
        "drift_um_per_10min": drift,
        "u_drift_um_per_10min": 1.0,
    }
    await store.append_step("analyse", 1, "analyse", end, [])
    await store.finish("complete", 0)
    return store.path
