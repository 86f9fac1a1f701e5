"""The scaled clock."""

import asyncio

import pytest

from catseye.drivers.roles.clock import SystemClock


async def test_bench_time_runs_faster_by_the_factor() -> None:
    clock = SystemClock(speed=1000.0)
    start = clock.monotonic_s()
    await clock.sleep(1.0)
    assert clock.monotonic_s() - start >= 1.0


class StepLoop(asyncio.SelectorEventLoop):
    """Its time passes only while somebody sleeps; its timers are late by a step that it states."""

    timer_step_s = 0.25
    now_s = 0.0

    def time(self) -> float:
        return self.now_s


@pytest.mark.parametrize(("duration_s", "asked_s"), [(3.0, [2.75, 0.0, 0.0]), (0.25, [0.0, 0.0])])
def test_only_the_timers_step_is_waited_for_without_one(
    monkeypatch: pytest.MonkeyPatch, duration_s: float, asked_s: list[float]
) -> None:
    asked: list[float] = []
    loop = StepLoop()

    async def sleep(delay_s: float) -> None:
        asked.append(delay_s)
        # Half a step passes in a round of the loop.
        loop.now_s += delay_s or 0.125

    with asyncio.Runner(loop_factory=lambda: loop) as runner:
        monkeypatch.setattr(asyncio, "sleep", sleep)
        runner.run(SystemClock().sleep(duration_s))
        monkeypatch.undo()
    assert asked == asked_s
