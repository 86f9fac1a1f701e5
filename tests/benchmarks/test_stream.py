"""A stream of 1000 samples a second at real speed: nothing is lost, and stamps are those of arrival.

CATSEYE_STREAM_S sets the duration, s: `make soak` takes ten minutes of it.
"""

import asyncio
import contextlib
import gc
import os
import signal
import sys
import time
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from catseye.drivers.roles.clock import SystemClock
from catseye.drivers.umd.display import TimedSample, UmdDisplay
from tests.benchmarks.stream_peers import RATE_HZ

ROOT = Path(__file__).parents[2]
DURATION_S = float(os.environ.get("CATSEYE_STREAM_S", "10"))
TARGET_P99_S = 1e-3
MOST = 20.0
"""Of the delay at which a bare asyncio stream has a line; of medians, which other work on the machine moves least.

Stamps of a consumer, instead of arrival, would come hundreds of times as late.
"""


@asynccontextmanager
async def peer(*arguments: str) -> AsyncIterator[str]:
    """Run a peer; yield its endpoint."""
    process = await asyncio.create_subprocess_exec(
        sys.executable,
        "-m",
        "tests.benchmarks.stream_peers",
        *arguments,
        cwd=ROOT,
        stdout=asyncio.subprocess.PIPE,
    )
    assert process.stdout is not None
    try:
        yield (await process.stdout.readline()).decode().strip()
    finally:
        with contextlib.suppress(ProcessLookupError):
            process.send_signal(signal.SIGKILL)
        await process.wait()


async def recorded(endpoint: str) -> tuple[list[TimedSample], int]:
    """Return the samples of the duration, and how many were lost."""
    driver = UmdDisplay.at(endpoint, SystemClock())
    await driver.connect()
    samples: list[TimedSample] = []
    try:
        async for sample in driver.samples():
            samples.append(sample)
            if len(samples) >= DURATION_S * RATE_HZ:
                break
    finally:
        await driver.close()
    return samples, driver.lost_samples


async def bare_s(endpoint: str, lines: int) -> "np.ndarray[tuple[int], np.dtype[np.float64]]":
    """Return how late a bare asyncio stream has each line of the emitter, s."""
    host, _, port = endpoint.removeprefix("tcp://").rpartition(":")
    reader, writer = await asyncio.open_connection(host, int(port))
    late_s = []
    for _ in range(lines):
        line = await reader.readline()
        late_s.append(time.monotonic() - int(line.split()[-1]) / 1e6)
    writer.close()
    with contextlib.suppress(OSError):
        await writer.wait_closed()
    return np.array(late_s)


def report(what: str, late_s: "np.ndarray[tuple[int], np.dtype[np.float64]]") -> float:
    p50, p99 = np.percentile(late_s, [50, 99])
    print(  # noqa: T201  # the figure is the result of a benchmark
        f"{what}: {late_s.size} samples, p50 {p50 * 1e3:.3f} ms, p99 {p99 * 1e3:.3f} ms, "
        f"largest {late_s.max() * 1e3:.3f} ms"
    )
    return float(p99)


@pytest.mark.timeout(2 * DURATION_S + 60)
async def test_stamps_are_those_of_arrival() -> None:
    # As the command `run` does before it measures.
    gc.collect()
    gc.freeze()
    try:
        async with peer("emitter") as endpoint:
            samples, lost = await recorded(endpoint)
        async with peer("emitter") as endpoint:
            plain_s = await bare_s(endpoint, len(samples))
    finally:
        gc.unfreeze()
    late_s = np.array([s.time_s - s.sample.low_data / 1e6 for s in samples])
    assert lost == 0
    assert {b.sample.sequence - a.sample.sequence for a, b in pairwise(samples)} == {1}
    report(f"stamp after writing (target of the p99 {TARGET_P99_S * 1e3:g} ms)", late_s)
    report("the same for a bare asyncio stream", plain_s)
    assert float(np.median(late_s)) <= MOST * float(np.median(plain_s))


@pytest.mark.timeout(DURATION_S + 60)
@pytest.mark.parametrize("line", ["tcp", "serial"])
async def test_the_emulated_display_loses_nothing(line: str, tmp_path: Path) -> None:
    where = {"tcp": "tcp://127.0.0.1:0", "serial": f"serial://{tmp_path}/umd?baud=3000000"}[line]
    async with peer("emulator", where) as endpoint:
        samples, lost = await recorded(endpoint)
    assert lost == 0
    assert {b.sample.sequence - a.sample.sequence for a, b in pairwise(samples)} == {1}
    time_s = np.array([s.time_s for s in samples])
    grid_s = time_s - np.arange(time_s.size) / RATE_HZ
    report(f"emulator over {line}, arrival after its moment", grid_s - grid_s.min())
