"""The store's promise against kill -9 and against a disk that refuses."""

import asyncio
import contextlib
import os
import random
import resource
import signal
import sqlite3
import subprocess
import sys
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.errors import StorageError
from app.store.catalog import list_runs
from app.store.reader import RunReader
from app.store.run_store import RunStore
from app.store.verify import verify
from drivers.clock import SystemClock
from procedures.context import Row, Table

KILLS = 40
SEED = 20260102
ROWS = 3
LONGEST_LIFE_S = 0.15
ROW: tuple[Table, Row] = ("search", {"reflector": "P1", "theta1_deg": 1.0, "theta2_deg": 2.0})


async def write(run: str | None, root: Path) -> None:
    """Store steps for ever; print each one when it has been acknowledged."""
    clock = SystemClock()
    if run is None:
        store = await RunStore.create(root, "kill", {}, clock, reserve_bytes=0)
    else:
        store = await RunStore.reopen(Path(run), clock, reserve_bytes=0)
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
    store = await RunStore.create(root, "full", {}, SystemClock(), reserve_bytes=0)
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


@contextlib.contextmanager
def child(*arguments: str) -> Iterator["subprocess.Popen[str]"]:
    """Run this file as a writer."""
    with subprocess.Popen(
        [sys.executable, "-m", "tests.system.test_store_kill", *arguments],
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            yield process
        finally:
            process.kill()


def killed(process: "subprocess.Popen[str]", life_s: float) -> tuple[Path, int]:
    """Kill a writer some time after it has begun; return its run and how many steps it had acknowledged."""
    output = process.stdout
    if output is None:
        raise AssertionError("the writer has no output")
    word, path = output.readline().split()
    assert word == "ready"
    timer = threading.Timer(life_s, process.send_signal, (signal.SIGKILL,))
    timer.start()
    # The last line may be cut by the kill.
    acknowledged = [int(line) for line in output if line.endswith("\n")]
    timer.join()
    assert process.wait() == -signal.SIGKILL
    return Path(path), len(acknowledged)


def check(run: Path, acknowledged: int) -> None:
    reader = RunReader(run)
    steps = [step.step_id for step in reader.steps()]
    assert reader.status == "died"
    assert steps == [f"s{number}" for number in range(len(steps))]
    # One step more may have been committed than the parent was told of.
    assert len(steps) >= acknowledged
    assert reader.count("search") == len(steps) * ROWS
    assert verify(run).problems == ()


def test_what_was_acknowledged_survives_a_kill_at_any_moment(tmp_path: Path) -> None:
    moments = random.Random(SEED)
    run: Path | None = None
    before = 0
    for kill in range(KILLS):
        with child("write", *([str(run)] if run else []), str(tmp_path)) as process:
            run, acknowledged = killed(process, moments.uniform(0.0, LONGEST_LIFE_S))
        check(run, acknowledged)
        count = RunReader(run).count("steps")
        assert count >= before, "a step that was done is gone"
        # Every fourth run is a new one, the others go on with what the kill has left.
        run, before = (None, 0) if kill % 4 == 3 else (run, count)
    assert len(list_runs(tmp_path)) == KILLS // 4


def test_a_disk_that_refuses_stops_the_store(tmp_path: Path) -> None:
    with child("fill", str(tmp_path)) as process:
        lines = process.communicate(timeout=30)[0].splitlines()
        assert process.returncode == 0
    assert lines == [str(number) for number in range(len(lines))]
    (run,) = list_runs(tmp_path)
    reader = RunReader(run.path)
    assert 0 < len(lines) <= reader.count("steps") < 10_000
    assert reader.status == "died"
    assert verify(run.path).problems == ()


@pytest.mark.parametrize("share", [0.3, 0.5, 0.9, 0.99])
def test_a_torn_log_loses_at_most_its_end(tmp_path: Path, share: float) -> None:
    with child("write", str(tmp_path)) as process:
        run, _ = killed(process, LONGEST_LIFE_S)
    before = RunReader(run).count("steps")
    log = run / "run.sqlite-wal"
    os.truncate(log, int(log.stat().st_size * share))
    (run / "run.sqlite-shm").unlink(missing_ok=True)
    reader = RunReader(run)
    assert reader.count("steps") <= before
    assert reader.count("search") == reader.count("steps") * ROWS
    assert verify(run).problems == ()


if __name__ == "__main__":
    mode, *rest = sys.argv[1:]
    with contextlib.suppress(BrokenPipeError, sqlite3.Error):
        if mode == "write":
            asyncio.run(write(rest[0] if len(rest) > 1 else None, Path(rest[-1])))
        else:
            asyncio.run(fill(Path(rest[-1])))
