"""A program that stores steps until it is killed, or until the disk refuses.

Arguments: `write` or `fill`, perhaps a run to go on with, root of the runs.
"""

import asyncio
import contextlib
import resource
import sqlite3
import sys
from pathlib import Path

from catseye.app.errors import StorageError
from catseye.app.store.run_store import RunStore
from catseye.drivers.roles.clock import SystemClock
from catseye.procedures.kit.records import Row
from tests.unit.app.store.fakes import RECORDS

ROWS = 3
ROW: tuple[str, Row] = ("search", {"reflector": "P1", "theta1_deg": 1.0, "theta2_deg": 2.0})


async def write(run: str | None, root: Path) -> None:
    """Store steps for ever; print each one when it has been acknowledged."""
    clock = SystemClock()
    if run is None:
        store = await RunStore.create(root, "kill", {}, clock, records=RECORDS, reserve_bytes=0)
    else:
        store = await RunStore.reopen(Path(run), clock, records=RECORDS, reserve_bytes=0)
    print("ready", store.path, flush=True)  # noqa: T201  # the parent reads it
    number = 0
    while True:
        if store.stored_result(f"s{number}") is None:
            await store.append_step(f"s{number}", 1, "title", {"number": number}, [ROW] * ROWS)
            await store.event("acknowledged", {"number": number})
        print(number, flush=True)  # noqa: T201  # the parent reads it
        number += 1


async def fill(root: Path) -> None:
    """Store steps until the disk refuses; check that nothing is taken after that."""
    store = await RunStore.create(root, "full", {}, SystemClock(), records=RECORDS, reserve_bytes=0)
    resource.setrlimit(resource.RLIMIT_FSIZE, (200_000, 200_000))
    number = 0
    try:
        while number < 10_000:
            await store.append_step(f"s{number}", 1, "title", {}, [ROW] * ROWS)
            print(number, flush=True)  # noqa: T201  # the parent reads it
            number += 1
    except StorageError:
        with contextlib.suppress(StorageError):
            await store.event("after")
            print("taken after the failure", flush=True)  # noqa: T201  # the parent reads it
        with contextlib.suppress(StorageError):
            await store.finish("complete", 0)
            print("closed after the failure", flush=True)  # noqa: T201  # the parent reads it


if __name__ == "__main__":
    mode, *rest = sys.argv[1:]
    with contextlib.suppress(BrokenPipeError, sqlite3.Error):
        if mode == "write":
            asyncio.run(write(rest[0] if len(rest) > 1 else None, Path(rest[-1])))
        else:
            asyncio.run(fill(Path(rest[-1])))
