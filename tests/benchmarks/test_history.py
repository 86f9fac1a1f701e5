"""The history of two thousand runs: reading it, and looking at it again, against the plain list of runs."""

import os
import time
from collections.abc import Callable
from itertools import islice
from pathlib import Path

import pytest

from catseye.app.store.catalog import list_runs
from catseye.app.store.history import RunHistory
from catseye.app.store.seal import DATABASE
from tests.unit.app.tui.stored_runs import COMPLETE, make_runs

RUNS = 2000
FIRST = 100
"""What a screen shows while the rest is still being read."""


@pytest.fixture
async def many(tmp_path: Path) -> Path:
    """A folder of complete runs."""
    (await make_runs(tmp_path / "few")).release()
    root = tmp_path / "many"
    for number in range(RUNS):
        folder = root / f"2026{number // 200 + 1:02d}01T{number % 24:02d}0000Z_open-loop_{number:06x}"
        folder.mkdir(parents=True)
        os.link(tmp_path / "few" / COMPLETE / DATABASE, folder / DATABASE)
    return root


def seconds(work: Callable[[], object]) -> float:
    start_s = time.perf_counter()
    work()
    return time.perf_counter() - start_s


def test_two_thousand_runs(many: Path) -> None:
    peer_s = min(seconds(lambda: list_runs(many)) for _ in range(3))
    history = RunHistory(many)
    changes = history.changes()
    first_s = seconds(lambda: list(islice(changes, FIRST)))
    whole_s = first_s + seconds(lambda: list(changes))
    assert len(history.lines) == RUNS
    again_s = min(seconds(lambda: list(history.changes())) for _ in range(5))
    text = (
        f"{RUNS} runs: list_runs (state only) {1e3 * peer_s:.0f} ms, history (state, duration, rows, cell) "
        f"{1e3 * whole_s:.0f} ms, its first {FIRST} after {1e3 * first_s:.0f} ms, looking again "
        f"{1e3 * again_s:.0f} ms ({peer_s / again_s:.0f} times quicker than list_runs)"
    )
    print(f"\n{text}")  # noqa: T201  # the figure
    assert whole_s < 1.5 * peer_s
    assert first_s < 0.25 * peer_s
    assert again_s < 0.2 * peer_s
