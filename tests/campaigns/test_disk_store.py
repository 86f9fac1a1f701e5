"""A store whose files are torn, altered, copied while they are written, or on a disk that fails at each single call.

`CATSEYE_FLIPS` and `CATSEYE_COPIES` say how often, `CATSEYE_SEED` repeats the moments.
"""

import os
import random
import shutil
import sqlite3
import time
from collections import Counter
from contextlib import closing
from pathlib import Path

import pytest

from catseye.app.store.reader import RunReader
from catseye.app.store.seal import DATABASE
from catseye.app.store.verify import verify
from tests.patience import HANG_S
from tests.system.command import environment
from tests.system.failing_disk import FAULTS, FailingDisk
from tests.system.interruptions import spawned
from tests.system.storing import ROWS
from tests.system.test_store_kill import child, killed
from tests.system.torn_runs import LOG, Told, copied, last_frame, require_sound, told_or_refused, torn

FLIPS = int(os.environ.get("CATSEYE_FLIPS", "1500"))
COPIES = int(os.environ.get("CATSEYE_COPIES", "100"))
SEED = int(os.environ.get("CATSEYE_SEED", "20261128"))
SINGLE_CALLS = {"write": 60, "sync": 24, "make": 8, "name": 4}
"""How many calls of each kind fail in turn while a run is created and stores its first steps."""


@pytest.fixture
def died(tmp_path: Path) -> tuple[Path, int]:
    """Return a run whose process was killed, and how many steps it had acknowledged."""
    with child("write", str(tmp_path / "runs")) as (process, lines):
        return killed(process, lines, 0.02)


@pytest.mark.timeout(7200)
def test_a_log_torn_in_its_last_frame_loses_one_transaction(died: tuple[Path, int], tmp_path: Path) -> None:
    run, acknowledged = died
    whole, copy = Told.by(run), copied(run, tmp_path / "copy")
    counts: Counter[int] = Counter()
    # Backwards: what is cut off stays cut off.
    for length in reversed(last_frame(run)):
        told = told_or_refused(torn(copy, length), whole)
        assert told is not None, length
        assert len(told.steps) >= acknowledged - 1, length
        if length % 256 == 0:
            require_sound(copy)
        counts[len(whole.events) - len(told.events) + len(whole.steps) - len(told.steps)] += 1
    assert set(counts) == {1}, counts
    report(
        f"log torn at {counts.total()} bytes of its last frame: the last transaction is gone each time, no other"
    )


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("name", [LOG, DATABASE])
def test_a_flipped_byte_invents_no_record(died: tuple[Path, int], tmp_path: Path, name: str) -> None:
    run, _ = died
    whole, copy = Told.by(run), copied(run, tmp_path / "copy")
    if name == DATABASE:
        # Without a log all is in the database.
        RunReader(copy)
        _checkpointed(copy)
    data, rng = (copy / name).read_bytes(), random.Random(f"{SEED} {name}")
    found: Counter[str] = Counter()
    for _ in range(FLIPS):
        changed = bytearray(data)
        changed[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
        (copy / name).write_bytes(changed)
        (copy / f"{DATABASE}-shm").unlink(missing_ok=True)
        told = told_or_refused(copy, whole)
        found["refused by name" if told is None else "whole" if told == whole else "its beginning"] += 1
    report(
        f"{FLIPS} bytes of {name} flipped (seed {SEED}): {dict(found)}; nothing was read that was not stored"
    )


@pytest.mark.timeout(7200)
def test_a_live_copy_is_a_beginning_or_refused(tmp_path: Path) -> None:
    rng = random.Random(SEED)
    found: Counter[str] = Counter()
    taken: list[tuple[Path, int]] = []
    with child("write", str(tmp_path / "runs")) as (process, lines):
        word, path = lines.readline().split()
        assert word == "ready"
        for number in range(COPIES):
            for _ in range(rng.randint(1, 30)):
                acknowledged = int(lines.readline()) + 1
            taken.append((_live_copy(Path(path), tmp_path / f"{number}", rng), acknowledged))
        process.kill()
        assert process.wait(HANG_S) < 0
    whole = Told.by(Path(path))
    for copy, acknowledged in taken:
        told = told_or_refused(copy, whole)
        if told is None or verify(copy).problems:
            found["refused by name"] += 1
        else:
            found[
                "all acknowledged before" if len(told.steps) >= acknowledged else "an earlier beginning"
            ] += 1
    report(
        f"{COPIES} copies of a run that was being written (seed {SEED}): {dict(found)}; the run itself is whole"
    )
    require_sound(Path(path))


@pytest.mark.timeout(7200)
def test_a_call_that_fails_loses_nothing(tmp_path: Path) -> None:
    disk = FailingDisk.built(tmp_path, tmp_path / "runs")
    found: Counter[str] = Counter()
    points = 0
    for calls, most in SINGLE_CALLS.items():
        for number in range(1, most + 1):
            fault = list(FAULTS)[number % len(FAULTS)]
            shutil.rmtree(tmp_path / "runs", ignore_errors=True)
            points += _filled(disk, disk.order(fault, calls, number, part=number % 3 * 100), tmp_path)
            found["met" if disk.struck else "not reached"] += 1
    report(
        f"single calls of the store that failed: {dict(found)}; {points} steps acknowledged before, all stored"
    )


def _filled(disk: FailingDisk, order: dict[str, str], folder: Path) -> int:
    """Store until the disk fails; return how many steps were acknowledged, each of which is there."""
    with (
        (folder / "said").open("wb") as said,
        spawned(
            *("tests.system.storing", ["fill", str(folder / "runs")]),
            cwd=Path.cwd(),
            env={**environment(), **order},
            err=said,
        ) as (process, lines),
    ):
        acknowledged = lines.read().splitlines()
        process.wait(HANG_S)
    runs = sorted((folder / "runs").glob("*_full_*"))
    if not acknowledged:
        return 0
    reader = RunReader(runs[0])
    assert acknowledged == [str(number) for number in range(len(acknowledged))], disk.struck
    assert len(acknowledged) <= reader.count("steps"), disk.struck
    assert reader.count("search") == reader.count("steps") * ROWS
    assert verify(runs[0]).problems == (), disk.struck
    return len(acknowledged)


def _live_copy(run: Path, folder: Path, rng: random.Random) -> Path:
    """Copy the files of a run in any order, some time between them."""
    copy = folder / run.name
    copy.mkdir(parents=True)
    names = [path.name for path in run.iterdir()]
    rng.shuffle(names)
    for name in names:
        shutil.copy(run / name, copy / name)
        time.sleep(rng.choice([0.0, 0.0, 0.02]))
    return copy


def _checkpointed(run: Path) -> None:
    with closing(sqlite3.connect(run / DATABASE)) as connection:
        connection.execute("PRAGMA wal_checkpoint(TRUNCATE)")
        connection.execute("PRAGMA journal_mode=DELETE")


def report(text: str) -> None:
    print(f"\n{text}, load {os.getloadavg()[0]:.1f}", flush=True)  # noqa: T201  # the figure
