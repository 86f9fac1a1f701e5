"""A door that is opened at many random moments of motion: how soon STOP reaches the controller.

`CATSEYE_DOOR_OPENINGS` says how many, `CATSEYE_DOOR_SEED` at which moments.
"""

import os
from pathlib import Path

import pytest

from tests.system.command import emulated
from tests.system.door_openings import SLOW, open_at_random, require_acknowledged

_OPENINGS = int(os.environ.get("CATSEYE_DOOR_OPENINGS", "200"))
_SEED = int(os.environ.get("CATSEYE_DOOR_SEED", "14"))

_SPEED = 2

STOP_S = 0.2
_ROUND_TRIP_S = 0.05
"""Between this program and the emulator on a machine that is at work."""


@pytest.mark.timeout(7200)
def test_the_arm_is_stopped_in_time(tmp_path: Path) -> None:
    with emulated(tmp_path, "--speed", str(_SPEED), edit=SLOW) as bench:
        openings, records = open_at_random(bench, tmp_path, _OPENINGS, _SEED, _SPEED)
    times_s = sorted(opening.stop_s for opening in openings)
    restarts = sum(opening.motions for opening in openings)
    acknowledged = sum(map(require_acknowledged, records))
    load = os.getloadavg()[0]
    print(  # noqa: T201  # the figure
        f"\nseed {_SEED}: {len(openings)} openings in {len(records)} runs; STOP after median "
        f"{times_s[len(times_s) // 2] * 1e3:.0f} ms, p99 {times_s[int(0.99 * (len(times_s) - 1))] * 1e3:.0f} ms, "
        f"longest {times_s[-1] * 1e3:.0f} ms; {restarts} restarts before the door was closed, {acknowledged} "
        f"acknowledgements; load {load:.1f} on {os.cpu_count()} cores"
    )
    assert restarts == 0
    assert acknowledged >= len(openings)
    assert times_s[-1] <= STOP_S + _ROUND_TRIP_S
