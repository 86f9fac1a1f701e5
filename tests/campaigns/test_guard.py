"""Programs that are killed, stopped or blocked at random moments of motion, and sound ones with both cores busy.

`CATSEYE_GUARD_MOMENTS` and `CATSEYE_SOUND_RUNS` shorten it.
"""

import os
import random
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from app.guard.client import LOG_NAME
from tests.system.command import Emulated, catseye, emulated, only
from tests.system.guarded import Program, measuring, until

SEED = 20261122
MOMENTS = int(os.environ.get("CATSEYE_GUARD_MOMENTS", "200"))
SOUND_RUNS = int(os.environ.get("CATSEYE_SOUND_RUNS", "300"))
STOPPED_WITHIN_S = 0.7
AT_REST_WITHIN_S = 1.0
WAYS = {"killed": signal.SIGKILL, "stopped": signal.SIGSTOP, "blocked": signal.SIGUSR2}
OVERRIDES_PERCENT = (1, 2, 5, 10, 20)
FEW_NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-40.0, -20.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 60.0]",
}


@pytest.fixture(params=OVERRIDES_PERCENT)
def bench(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[tuple[int, Emulated]]:
    cap = {"override_cap_percent = 20 ": f"override_cap_percent = {request.param} "}
    with emulated(tmp_path, "--speed", "1", edit=cap) as running:
        yield request.param, running


def tell(text: str) -> None:
    print(f"\n{text}", flush=True)  # noqa: T201  # the figure


def load() -> str:
    return f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"


def ended_s(run: Program, number: int) -> tuple[float, float] | None:
    """Send a signal; return the real seconds until STOP was read and until the arm stood, None if it did not move."""
    state = run.bench.ask(op="state")
    if not state["moving"] or run.process.poll() is not None:
        return None
    sent_s, bench_s = time.monotonic(), float(run.bench.ask(op="state")["time_s"])
    run.send(number)
    until(lambda: not run.moving)
    rest_s = time.monotonic() - sent_s
    entries = run.bench.ask(op="log", device="robot")["entries"]
    stops = [
        e["time_s"] - bench_s
        for e in entries
        if e["kind"] == "request" and e["text"].endswith("STOP") and e["time_s"] >= bench_s
    ]
    motions = [e["text"] for e in entries if e["kind"] == "motion" and e["time_s"] >= bench_s]
    # An arm that had just arrived by itself proves nothing.
    return (stops[0], rest_s) if stops and motions and motions[0].startswith("stop towards") else None


@pytest.mark.timeout(14400)
def test_no_arm_moves_on(bench: tuple[int, Emulated]) -> None:
    percent, running = bench
    moments = random.Random(SEED + percent)
    wanted = -(-MOMENTS // len(OVERRIDES_PERCENT))
    times: dict[str, list[tuple[float, float]]] = {way: [] for way in WAYS}
    while sum(map(len, times.values())) < wanted:
        way = moments.choice(list(WAYS))
        with measuring(running, "tests.system.blockable") as run:
            run.until_moving()
            time.sleep(moments.uniform(0.0, 3.0))
            until(lambda run=run: run.moving or run.process.poll() is not None)  # type: ignore[misc]  # bound at once
            if (found := ended_s(run, WAYS[way])) is not None:
                times[way].append(found)
    for way, found_s in times.items():
        if found_s:
            stop_s, rest_s = (max(column) for column in zip(*found_s, strict=True))
            tell(
                f"{percent} %, {way}: {len(found_s)} moments (seed {SEED + percent}; {load()}), STOP after at most "
                f"{stop_s:.3f} s, at rest after at most {rest_s:.3f} s"
            )
    every = [found for found_s in times.values() for found in found_s]
    assert max(stop_s for stop_s, _ in every) <= STOPPED_WITHIN_S
    assert max(rest_s for _, rest_s in every) <= AT_REST_WITHIN_S


@contextmanager
def busy_cores() -> Iterator[None]:
    hogs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count() or 1)]
    try:
        yield
    finally:
        for hog in hogs:
            hog.kill()
            hog.wait()


@pytest.mark.timeout(14400)
def test_no_sound_run_is_stopped(tmp_path: Path) -> None:
    with emulated(tmp_path, edit={**FEW_NODES, **only("P2")}) as running, busy_cores():
        for _ in range(SOUND_RUNS):
            words = ["--search", "none", "--speed", "400", "--json"]
            done = catseye("run", "open-loop", "--cell", running.cell, *words, cwd=tmp_path)
            assert "the guard" not in done.stderr + done.stdout, done.stderr
        log = (tmp_path / "catseye-runs" / LOG_NAME).read_text(encoding="utf-8")
        tell(f"{SOUND_RUNS} sound runs with both cores busy ({load()}): {len(log.splitlines())} false STOPs")
    assert log == ""
