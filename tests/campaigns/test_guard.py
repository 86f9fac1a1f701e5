"""Programs that are killed, stopped or blocked at random moments of motion, and sound ones with both cores busy.

`CATSEYE_GUARD_MOMENTS` and `CATSEYE_SOUND_RUNS` shorten it, `CATSEYE_SEED` repeats it.
"""

import os
import random
import signal
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path

import pytest

from catseye.app.guard.client import LOG_NAME
from tests.system.command import SPEED, Emulated, catseye, emulated, only
from tests.system.guarded import Program, measuring, until

SEED = int(os.environ.get("CATSEYE_SEED", "20261122"))
MOMENTS = int(os.environ.get("CATSEYE_GUARD_MOMENTS", "200"))
SOUND_RUNS = int(os.environ.get("CATSEYE_SOUND_RUNS", "300"))
KILLED_WITHIN_S = 0.1
STOPPED_WITHIN_S = 0.7
AT_REST_WITHIN_S = 1.0
MOST_TRIED = 2
WAYS = {"killed": signal.SIGKILL, "stopped": signal.SIGSTOP, "blocked": signal.SIGUSR2}
OVERRIDES_PERCENT = (1, 2, 5, 10, 20)
CAP = "override_cap_percent = 20 "
WAIT_S = 1.0
FEW_NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-40.0, -20.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [40.0, 60.0]",
}


@dataclass(frozen=True)
class Moment:
    """What became of an arm whose program was in trouble while it moved, by the controller's own notes.

    Attributes:
        way: the trouble.
        stop_s: from the trouble to the first STOP that was read; infinite when none was.
        rest_s: from the trouble to the standstill.
        arrived: the arm was at its target before STOP was read.
    """

    way: str
    stop_s: float
    rest_s: float
    arrived: bool


@dataclass(frozen=True)
class Searched:
    """A bench in real time whose reflector has been found: a run on it moves from point to point."""

    bench: Emulated
    search: Path


def searched(bench: Emulated) -> Path:
    """Search the reflectors; return the run."""
    folder = bench.cell.parent
    done = catseye("run", "reflector-search", "--cell", bench.cell, "--speed", SPEED, cwd=folder)
    assert done.returncode == 0, done.stderr
    (found,) = (folder / "catseye-runs").glob("*_reflector-search_*")
    return found


@pytest.fixture(scope="module")
def found_bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Searched]:
    with emulated(tmp_path_factory.mktemp("guard"), edit=only("P2")) as bench:
        search = searched(bench)
        bench.ask(op="speed", value=1.0)
        yield Searched(bench, search)


def capped(bench: Emulated, percent: int) -> Emulated:
    """Return the bench with a cell file of its own, which caps the override."""
    text = bench.cell.read_text(encoding="utf-8")
    assert CAP in text
    cell = bench.cell.parent / f"at-{percent}" / bench.cell.name
    cell.parent.mkdir()
    cell.write_text(text.replace(CAP, f"override_cap_percent = {percent} "), encoding="utf-8")
    return replace(bench, cell=cell)


def report(text: str) -> None:
    print(f"\n{text}", flush=True)  # noqa: T201  # the figure


def load() -> str:
    return f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"


def begun(run: Program, moments: random.Random) -> None:
    """Wait for a random moment of motion."""
    run.until_moving()
    time.sleep(moments.uniform(0.0, WAIT_S))
    run.until_moving()


def troubled(run: Program, way: str) -> Moment | None:
    """Bring the trouble upon a program and see what becomes of its arm; None if that stood before."""
    state = run.bench.ask(op="state")
    since_s = float(state["time_s"])
    if not state["moving"]:
        return None
    run.send(WAYS[way])
    until(lambda: not run.moving)
    after = noted(run.bench, since_s)
    arrived = not any(text.startswith("stop towards") for _, _, text in after)
    if arrived:
        # STOP is still to come.
        time.sleep(STOPPED_WITHIN_S)
        after = noted(run.bench, since_s)
    stops_s = [time_s for time_s, kind, text in after if kind == "request" and text.endswith("STOP")]
    arrivals_s = [time_s for time_s, _, text in after if text.startswith("arrival")]
    return Moment(way, min(stops_s, default=float("inf")), min(arrivals_s), arrived)


def noted(bench: Emulated, since_s: float) -> list[tuple[float, str, str]]:
    """Return what the emulated controller has noted since a time: seconds from then, kind and text."""
    entries = bench.ask(op="log", device="robot")["entries"]
    return [(e["time_s"] - since_s, e["kind"], e["text"]) for e in entries if e["time_s"] >= since_s]


def describe(percent: int, found: list[Moment]) -> str:
    """Return the figures of one way at one override."""
    arrived = sum(moment.arrived for moment in found)
    stops_s = sorted(moment.stop_s for moment in found)
    rests_s = [moment.rest_s for moment in found if not moment.arrived]
    return (
        f"{percent} %, {found[0].way}: {len(found)} moments (seed {SEED + percent}; {load()}), STOP after "
        f"{statistics.median(stops_s):.3f} s (median), {stops_s[-1]:.3f} s (longest); at rest after at most "
        f"{max(rests_s, default=0.0):.3f} s; {arrived} had arrived by themselves before STOP"
    )


@pytest.mark.timeout(7200)
@pytest.mark.parametrize("percent", OVERRIDES_PERCENT)
def test_no_arm_moves_on(found_bench: Searched, percent: int) -> None:
    moments = random.Random(SEED + percent)
    running = capped(found_bench.bench, percent)
    found: list[Moment] = []
    stood = 0
    begun_s = time.monotonic()
    # A fast arm is often at its target before STOP is due: such a moment shows a STOP, but no arm that it stopped.
    while sum(not moment.arrived for moment in found) < -(-MOMENTS // len(OVERRIDES_PERCENT)):
        way = moments.choice(list(WAYS))
        with measuring(running, "tests.system.blockable", found_bench.search) as run:
            begun(run, moments)
            moment = troubled(run, way)
        if moment is None:
            stood += 1
        else:
            found.append(moment)
        assert stood + len(found) <= MOST_TRIED * MOMENTS
    for way in WAYS:
        if of_way := [moment for moment in found if moment.way == way]:
            report(describe(percent, of_way))
    report(
        f"{(time.monotonic() - begun_s) / len(found):.1f} s a moment; {stood} more stood before the trouble"
    )
    assert max(moment.stop_s for moment in found) <= STOPPED_WITHIN_S
    assert all(moment.stop_s <= KILLED_WITHIN_S for moment in found if moment.way == "killed")
    assert max(moment.rest_s for moment in found if not moment.arrived) <= AT_REST_WITHIN_S


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
        begun_s = time.monotonic()
        searched(running)
        for _ in range(SOUND_RUNS):
            words = ["--speed", SPEED, "--json"]
            done = catseye("run", "open-loop", "--cell", running.cell, *words, cwd=tmp_path)
            assert done.returncode == 0, done.stderr
            assert "the guard" not in done.stderr + done.stdout, done.stderr
        log = (tmp_path / "catseye-runs" / LOG_NAME).read_text(encoding="utf-8")
        took_s = (time.monotonic() - begun_s) / SOUND_RUNS
        false = len(log.splitlines())
        report(
            f"{SOUND_RUNS} sound runs, {took_s:.1f} s each, all cores busy ({load()}): {false} false STOPs"
        )
    assert log == ""
