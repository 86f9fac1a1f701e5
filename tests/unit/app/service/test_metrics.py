"""The metrics of a run: what the file says, how often it is written, and what a failure means."""

import asyncio
import math
import os
import threading
from collections.abc import AsyncIterator, Callable
from contextlib import asynccontextmanager
from datetime import UTC, datetime
from pathlib import Path

import pytest

from catseye.app.errors import StorageError, UsageError
from catseye.app.protocol.run_events import (
    LiveData,
    LiveShown,
    PointMeasured,
    Progressed,
    PromptAnswered,
    PromptAsked,
    RunEnded,
    RunEvent,
    StateChanged,
)
from catseye.app.protocol.state import ControlState
from catseye.app.service.metrics import STALE_S, MetricsFile, Surroundings, require_metrics_file
from catseye.drivers.roles.air import AirSample
from tests.patience import HANG_S
from tests.unit.app.engine.fakes import ManualClock
from tests.unit.app.service.attended import handle_with

QUIET = Surroundings(
    lambda: AirSample(20.5, 1013.25, None), lambda: {"counter at tcp://a:1": 3}, lambda: 5_000_000
)
ENDED = RunEnded(status="stopped", exit_code=130, text="", path="runs/r1", drives_on=False)


class Shelf:
    """Takes files in place of a disk.

    Attributes:
        texts: what was written.
        asked: how many files were to be written.
        failure: is raised by every further one; None for none.
        free: unset while the disk does not answer.
    """

    def __init__(self) -> None:
        self.texts: list[str] = []
        self.asked = 0
        self.failure: StorageError | None = None
        self.free = threading.Event()
        self.free.set()

    def write(self, _path: Path, text: str) -> None:
        self.asked += 1
        assert self.free.wait(HANG_S)
        if self.failure is not None:
            raise self.failure
        self.texts.append(text)


class WatchedClock(ManualClock):
    """Says whether somebody sleeps, so that a test does not move on before that."""

    def __init__(self) -> None:
        super().__init__()
        self.asleep = 0

    async def sleep(self, duration_s: float) -> None:
        self.asleep += 1
        try:
            await super().sleep(duration_s)
        finally:
            self.asleep -= 1


class Kept:
    """A metrics file that is kept up to date."""

    def __init__(self) -> None:
        self.clock, self.shelf, self.warnings = WatchedClock(), Shelf(), list[str]()
        self.file = MetricsFile(
            Path("m"), {"cell": "lab-1", "procedure": "search"}, QUIET, self.clock, self.shelf.write
        )
        self.publish = self.file.before(lambda _event: None)

    async def until(self, condition: Callable[[], bool]) -> None:
        async with asyncio.timeout(HANG_S):
            while not condition():  # noqa: ASYNC110  # threads write
                await asyncio.sleep(0)

    async def second(self) -> None:
        """Let a second pass, once what was to be done at this time is done."""
        await self.until(lambda: self.clock.asleep > 0)
        self.clock.advance(1.0)
        await asyncio.sleep(0)


@asynccontextmanager
async def kept() -> AsyncIterator[Kept]:
    one = Kept()
    async with one.file.kept(handle_with(one.warnings)):
        await one.until(lambda: bool(one.shelf.texts))
        yield one


def live(value: float, expanded: float = 0.0) -> LiveShown:
    data = LiveData(
        name="innovation",
        value=value,
        unit="µm",
        low=-9.0,
        high=9.0,
        accepted=True,
        text="",
        expanded=expanded,
    )
    return LiveShown(state=ControlState.EXECUTE, data=data)


async def written_after(*events: RunEvent) -> list[str]:
    """Return the lines of the last file of a run with these events."""
    async with kept() as one:
        for event in events:
            one.publish(event)
    return one.shelf.texts[-1].splitlines()


LABELS = 'cell="lab-1",procedure="search",run="r1"'


async def test_state_is_one_of_all_states() -> None:
    lines = await written_after(StateChanged(state=ControlState.EXECUTE))
    states = [line for line in lines if line.startswith("catseye_run_state{")]
    assert len(states) == len(ControlState)
    assert [line for line in states if line.endswith(" 1.0")] == [
        f'catseye_run_state{{{LABELS},catseye_run_state="EXECUTE"}} 1.0'
    ]


async def test_points_are_counted() -> None:
    point = PointMeasured(step="s", point={})
    assert f"catseye_run_points_total{{{LABELS}}} 3.0" in await written_after(point, point, point)


async def test_innovations_have_rms_and_uncertainty() -> None:
    lines = await written_after(live(3.0), live(-4.0, expanded=2.5))
    labels = f'{LABELS},quantity="innovation",unit="µm"'
    assert f"catseye_live{{{labels}}} -4.0" in lines
    assert f"catseye_live_rms{{{labels}}} {math.sqrt(12.5)!r}" in lines
    assert f"catseye_live_expanded_uncertainty{{{labels}}} 2.5" in lines


async def test_a_value_without_symmetric_band_has_no_rms() -> None:
    data = LiveData(name="signal", value=0.8, unit="", low=0.1, high=1.0, accepted=True, text="")
    lines = await written_after(LiveShown(state=ControlState.EXECUTE, data=data))
    assert not [line for line in lines if line.startswith("catseye_live_rms")]


async def test_progress_question_and_end_are_stated() -> None:
    progress = Progressed(
        done=30.0, total=120.0, text="", elapsed_bench_s=1.0, left_bench_s=2.0, elapsed_s=3.0, left_s=4.0
    )
    prompt = PromptAsked(id="door", kind="confirm", text="Close it.")
    asked = await written_after(progress, prompt)
    assert f"catseye_run_progress_ratio{{{LABELS}}} 0.25" in asked
    assert f"catseye_run_left_seconds{{{LABELS}}} 4.0" in asked
    assert f"catseye_run_prompt_open{{{LABELS}}} 1.0" in asked
    ended = await written_after(prompt, PromptAnswered(id="door", answer="yes", who="Ada"), ENDED)
    assert f"catseye_run_prompt_open{{{LABELS}}} 0.0" in ended
    assert f"catseye_run_exit_code{{{LABELS}}} 130.0" in ended


async def test_surroundings_and_time_are_stated() -> None:
    lines = await written_after()
    now_s = datetime(2026, 1, 2, 3, 4, 5, tzinfo=UTC).timestamp()
    assert f"catseye_air_celsius{{{LABELS}}} 20.5" in lines
    assert not [line for line in lines if "humidity" in line]
    assert f'catseye_link_heals_total{{{LABELS},link="counter at tcp://a:1"}} 3.0' in lines
    assert f"catseye_runs_free_bytes{{{LABELS}}} 5000000.0" in lines
    assert f"catseye_written_timestamp_seconds{{{LABELS}}} {now_s!r}" in lines
    assert lines[-1] == "# EOF"


async def test_many_events_are_one_file_a_second() -> None:
    async with kept() as one:
        for _ in range(100):
            one.publish(PointMeasured(step="s", point={}))
        await one.until(lambda: one.clock.asleep > 0)
        assert len(one.shelf.texts) == 1
        await one.second()
        await one.until(lambda: one.clock.asleep > 0)
        assert len(one.shelf.texts) == 2
    assert "} 100.0\n" in one.shelf.texts[1]


async def test_without_news_the_file_stays_ten_seconds() -> None:
    async with kept() as one:
        for _ in range(int(STALE_S)):
            await one.second()
            assert len(one.shelf.texts) == 1
        await one.until(lambda: len(one.shelf.texts) == 2)


async def test_a_disk_that_does_not_answer_holds_nothing() -> None:
    async with kept() as one:
        one.shelf.free.clear()
        one.publish(PointMeasured(step="s", point={}))
        await one.second()
        for _ in range(5):
            one.publish(PointMeasured(step="s", point={}))
            one.clock.advance(1.0)
            await asyncio.sleep(0)
        assert len(one.shelf.texts) == 1
        one.shelf.free.set()
    # What waited meanwhile is not made up for: one file was under way, and the last one says it all.
    assert len(one.shelf.texts) == 3
    assert f"catseye_run_points_total{{{LABELS}}} 6.0\n" in one.shelf.texts[-1]


async def test_failures_are_one_warning_and_no_more() -> None:
    async with kept() as one:
        one.shelf.failure = StorageError("m: cannot be written: disk full")
        for _ in range(3):
            one.publish(PointMeasured(step="s", point={}))
            await one.second()
        await one.until(lambda: one.shelf.asked == 4)
    assert len(one.warnings) == 1
    assert "disk full" in one.warnings[0]


def test_a_pipe_is_refused_before_the_run(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    with pytest.raises(UsageError, match="no regular file"):
        require_metrics_file(tmp_path / "pipe")
