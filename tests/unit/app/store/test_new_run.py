"""Runs are named in the order in which they were made, whatever becomes of the clock."""

from datetime import UTC, datetime
from pathlib import Path

import pytest

from catseye.app.store.new_run import make_directory
from catseye.app.store.run_names import run_folders, run_name
from tests.unit.app.engine.fakes import ManualClock


class _SetClock(ManualClock):
    """A clock on the wall that somebody sets."""

    def __init__(self) -> None:
        super().__init__()
        self.utc = datetime(2026, 3, 1, 2, 30, tzinfo=UTC)

    def now_utc(self) -> datetime:
        return self.utc


def test_a_clock_set_back_leaves_the_order_of_runs(tmp_path: Path) -> None:
    clock, made = _SetClock(), []
    for hour in (2, 1, 1, 3):
        clock.utc = clock.utc.replace(hour=hour)
        made.append(make_directory(tmp_path, "warmup", clock, 0).name)
    assert [path.name for path, _ in run_folders(tmp_path)] == made
    assert [name[:16] for name in made] == [
        "20260301T023000Z",
        "20260301T023001Z",
        "20260301T023002Z",
        "20260301T033000Z",
    ]


@pytest.mark.parametrize("name", ["20261399T010203Z_warmup_abcdef", "20260101T256199Z_warmup_abcdef"])
def test_no_such_day_is_no_run(name: str, tmp_path: Path) -> None:
    (tmp_path / name).mkdir()
    assert run_name(name) is None
    assert make_directory(tmp_path, "warmup", _SetClock(), 0).name.startswith("20260301T023000Z")
