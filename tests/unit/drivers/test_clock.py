"""The scaled clock."""

from catseye.drivers.roles.clock import SystemClock


async def test_bench_time_runs_faster_by_the_factor() -> None:
    clock = SystemClock(speed=1000.0)
    start = clock.monotonic_s()
    await clock.sleep(1.0)
    assert clock.monotonic_s() - start >= 1.0
