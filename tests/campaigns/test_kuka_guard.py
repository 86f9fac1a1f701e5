"""Whole runs on a KUKA that are killed at random moments of motion: how soon the arm stands, and whether they resume.

`CATSEYE_GUARD_MOMENTS` shortens it, `CATSEYE_SEED` repeats it.
"""

import os
import random
import statistics
from pathlib import Path

import pytest

from tests.system.command import catseye, emulated
from tests.system.kuka_kills import EXAMPLE, REST_WITHIN_S, SLOW, Kill, killed, measuring, newest

SEED = int(os.environ.get("CATSEYE_SEED", "20261124"))
MOMENTS = int(os.environ.get("CATSEYE_GUARD_MOMENTS", "100"))
SPEED = 20.0


@pytest.mark.timeout(7200)
def test_no_killed_run_moves_on(tmp_path: Path) -> None:
    moments = random.Random(SEED)
    found: list[Kill] = []
    with emulated(tmp_path, text=EXAMPLE.read_text(encoding="utf-8"), edit=SLOW) as bench:
        found.append(killed(bench, moments, *measuring(bench)))
        while len(found) < MOMENTS:
            found.append(killed(bench, moments, "resume", newest(bench)))
        bench.ask(op="speed", value=SPEED)
        done = catseye("resume", newest(bench), "--speed", str(SPEED), cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    rests_s = sorted(kill.rest_s for kill in found)
    heard = [kill.stop_s for kill in found if kill.stop_s is not None]
    print(  # noqa: T201  # the figure
        f"\nseed {SEED}: {len(found)} killed runs, {len(heard)} STOPs by the guard after "
        f"{statistics.median(heard):.3f} s (median), {max(heard):.3f} s (longest); at rest after "
        f"{statistics.median(rests_s):.3f} s (median), {rests_s[-1]:.3f} s (longest), "
        f"{sum(kill.orders for kill in found)} orders and {sum(kill.motions for kill in found)} motions afterwards; "
        f"resumed to the end, load {os.getloadavg()[0]:.1f}"
    )
    assert rests_s[-1] < REST_WITHIN_S
    assert all(kill.orders == kill.motions == 0 for kill in found)
