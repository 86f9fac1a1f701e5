"""Robots of two makes stop: on request whatever their links do, and by themselves when their program is gone.

The campaign of the same is `tests/campaigns/test_serial_stop_moments.py`.
"""

import random
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from catseye.app.testing.proxy import ProxyThread
from catseye.drivers.links.motions import HEALING_S
from tests.patience import HANG_S
from tests.system.arm_stops import Figures, one_stop, unseen_s
from tests.system.command import Emulated, catseye, emulated, environment, own_runtime
from tests.system.guarded import until
from tests.system.kuka_kills import EXAMPLE, REST_WITHIN_S, SLOW, killed, measuring, newest
from tests.system.makes import MAKES, Make

SEED = 20261124
STOPS = 6
KILLS = 2
MOVER = "tests.system.arm_mover"
GUARD_S = 0.25
"""A guard says STOP when its engine's end of a pipe closes, which takes a moment; controller and program follow."""

LATE_S = 1.0
"""What a busy machine may add; the healing of a silent connection would go on for ten seconds."""

HEARTBEAT_S = 0.5
"""After the last sign of life a program on a controller stops the arm at the latest (docs/kuka.md, docs/abb.md)."""


@contextmanager
def served(make: Make, folder: Path) -> Iterator[tuple[Emulated, str]]:
    """Emulate the example in real time; yield it with the controller's endpoint."""
    with own_runtime(), emulated(folder, text=make.example.read_text(encoding="utf-8")) as bench:
        bench.ask(op="speed", value=1.0)
        found = re.search(r'^endpoint = "(.+?)"', bench.cell.read_text(encoding="utf-8"), re.MULTILINE)
        assert found is not None
        yield bench, found[1]


def is_moving(bench: Emulated) -> bool:
    return bool(bench.ask(op="arm")["moving"])


def rest_after_kill_s(bench: Emulated, *words: str) -> float:
    """Kill a program while it moves the arm; return the bench time from then to the standstill, s."""
    process = subprocess.Popen(
        [sys.executable, "-m", MOVER, *words],
        cwd=bench.cell.parent,
        env=environment(),
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        until(lambda: is_moving(bench) or process.poll() is not None)
        assert process.poll() is None, process.communicate()[1]
        # Heartbeats have come for a while.
        time.sleep(1.0)
        assert is_moving(bench)
        killed_s = float(bench.ask(op="arm")["time_s"])
        process.kill()
        until(lambda: not is_moving(bench))
        arrivals = [
            entry["time_s"]
            for entry in bench.ask(op="log", device="robot")["entries"]
            if entry["text"].startswith("arrival")
        ]
        return float(arrivals[-1]) - killed_s
    finally:
        process.kill()
        process.communicate(timeout=HANG_S)


@pytest.mark.parametrize("make", MAKES.values(), ids=MAKES)
async def test_stop_is_heard_whatever_a_link_does(make: Make) -> None:
    source, found = random.Random(SEED), Figures()
    with ProxyThread("proxies") as threads:
        async with make.bench() as bench:
            for _ in range(STOPS):
                await one_stop(make, bench, source, threads, found)
    assert (found.unconfirmed, found.moving, found.deaf, found.twice) == (0, 0, 0, 0)
    assert max(found.brakes_s) < 0.5


@pytest.mark.parametrize("make", MAKES.values(), ids=MAKES)
async def test_an_arm_that_is_not_seen_is_stopped(make: Make) -> None:
    with ProxyThread("proxies") as threads:
        async with make.bench() as bench:
            unseen = await unseen_s(make, bench, threads)
    # It is stopped for that, neither by the end of signs of life nor once the healing is given up.
    assert unseen > HEARTBEAT_S
    assert unseen < make.impatient.answer_timeout_s + HEALING_S + LATE_S


@pytest.mark.parametrize("how", ["guarded", "alone"])
@pytest.mark.parametrize("name", MAKES)
def test_the_arm_stops_when_its_program_is_killed(tmp_path: Path, name: str, how: str) -> None:
    make = MAKES[name]
    with served(make, tmp_path) as (bench, endpoint):
        rest_s = rest_after_kill_s(bench, name, endpoint, how)
        written = [e["text"] for e in bench.ask(op="log", device="robot")["entries"]]
        assert (make.stop in written) == (how == "guarded")
    # The last heartbeat may have come a period before the end; a cycle and the deceleration follow.
    assert rest_s < (GUARD_S if how == "guarded" else HEARTBEAT_S) + 0.25


def test_a_run_killed_in_motion_rests_at_once_and_resumes(tmp_path: Path) -> None:
    moments = random.Random(SEED)
    with own_runtime(), emulated(tmp_path, text=EXAMPLE.read_text(encoding="utf-8"), edit=SLOW) as bench:
        words = measuring(bench)
        for _ in range(KILLS):
            kill = killed(bench, moments, *words)
            assert kill.rest_s < REST_WITHIN_S
            assert (kill.orders, kill.motions) == (0, 0)
            words = ("resume", newest(bench))
        bench.ask(op="speed", value=20.0)
        done = catseye("resume", newest(bench), "--speed", "20", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert "The controller's speed override is 0 %" in done.stderr
    assert "run complete" in done.stderr
