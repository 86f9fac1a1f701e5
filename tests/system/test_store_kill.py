"""The store's promise against kill -9 and against a disk that refuses."""

import contextlib
import os
import random
import signal
import tempfile
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import pytest

from catseye.app.store.catalog import list_runs
from catseye.app.store.reader import RunReader
from catseye.app.store.verify import verify
from tests.patience import HANG_S
from tests.system import forked
from tests.system.command import environment
from tests.system.storing import ROWS
from tests.system.torn_runs import Told, copied, last_frame, told_or_refused, torn

KILLS = 40
SEED = 20260102
LONGEST_LIFE_S = 0.15


@contextlib.contextmanager
def child(*arguments: str) -> Iterator[tuple[forked.Forked, IO[str]]]:
    """Run a writer."""
    with (
        tempfile.TemporaryFile() as said,
        forked.talking(
            "tests.system.storing", arguments, cwd=Path.cwd(), env=environment(), err=said
        ) as talking,
    ):
        yield talking


def killed(process: forked.Forked, lines: IO[str], life_s: float) -> tuple[Path, int]:
    """Kill a writer some time after it has begun; return its run and how many steps it had acknowledged."""
    word, path = lines.readline().split()
    assert word == "ready"
    timer = threading.Timer(life_s, process.kill)
    timer.start()
    # The last line may be cut by the kill.
    acknowledged = [int(line) for line in lines if line.endswith("\n")]
    timer.join()
    assert process.wait(HANG_S) == -signal.SIGKILL
    return Path(path), len(acknowledged)


def check(run: Path, acknowledged: int) -> None:
    reader = RunReader(run)
    steps = [step.step_id for step in reader.steps()]
    assert reader.status == "died"
    assert steps == [f"s{number}" for number in range(len(steps))]
    # One step more may have been committed than the parent knows of.
    assert len(steps) >= acknowledged
    assert reader.count("search") == len(steps) * ROWS
    assert verify(run).problems == ()


def test_what_was_acknowledged_survives_a_kill_at_any_moment(tmp_path: Path) -> None:
    moments = random.Random(SEED)
    run: Path | None = None
    before = 0
    for kill in range(KILLS):
        with child("write", *([str(run)] if run else []), str(tmp_path)) as (process, lines):
            run, acknowledged = killed(process, lines, moments.uniform(0.0, LONGEST_LIFE_S))
        check(run, acknowledged)
        count = RunReader(run).count("steps")
        assert count >= before, "a step that was done is gone"
        # Every fourth run is a new one, the others go on with what the kill has left.
        run, before = (None, 0) if kill % 4 == 3 else (run, count)
    assert len(list_runs(tmp_path)) == KILLS // 4


def test_a_disk_that_refuses_stops_the_store(tmp_path: Path) -> None:
    with child("fill", str(tmp_path)) as (process, output):
        lines = output.read().splitlines()
        assert process.wait(HANG_S) == 0
    assert lines == [str(number) for number in range(len(lines))]
    (run,) = list_runs(tmp_path)
    reader = RunReader(run.path)
    assert 0 < len(lines) <= reader.count("steps") < 10_000
    assert reader.status == "died"
    assert verify(run.path).problems == ()


@pytest.mark.parametrize("share", [0.3, 0.5, 0.9, 0.99])
def test_a_torn_log_loses_at_most_its_end(tmp_path: Path, share: float) -> None:
    with child("write", str(tmp_path)) as (process, lines):
        run, _ = killed(process, lines, LONGEST_LIFE_S)
    before = RunReader(run).count("steps")
    log = run / "run.sqlite-wal"
    os.truncate(log, int(log.stat().st_size * share))
    (run / "run.sqlite-shm").unlink(missing_ok=True)
    reader = RunReader(run)
    assert reader.count("steps") <= before
    assert reader.count("search") == reader.count("steps") * ROWS
    assert verify(run).problems == ()


def test_a_log_torn_in_its_last_frame_loses_that_transaction(tmp_path: Path) -> None:
    with child("write", str(tmp_path / "runs")) as (process, lines):
        run, acknowledged = killed(process, lines, 0.02)
    whole, copy = Told.by(run), copied(run, tmp_path / "copy")
    # A campaign tears it at each byte. Backwards: what is cut off stays cut off.
    for length in reversed(last_frame(run)[::256]):
        told = told_or_refused(torn(copy, length), whole)
        assert told is not None, length
        assert len(told.events) + len(told.steps) == len(whole.events) + len(whole.steps) - 1
        assert len(told.steps) >= acknowledged - 1
