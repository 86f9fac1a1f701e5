"""The paper's whole plan, three reflectors, with each way of following: no beam is lost anywhere."""

import subprocess
import sys
from pathlib import Path

import pytest

from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader
from tests.system.command import emulated, environment, last_run
from tests.system.test_ways_of_following import DOORS


def run(cell: Path, folder: Path, procedure: str, speed: str) -> RunReader:
    """Run a procedure to its end, however long it takes, and return its record."""
    command = [sys.executable, "-m", "catseye", "run", procedure, "--cell", str(cell), "--speed", speed]
    done = subprocess.run(command, cwd=folder, env=environment(), capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return RunReader(resolve_run(folder / "catseye-runs", last_run(folder, procedure)))


@pytest.mark.timeout(1800)
@pytest.mark.parametrize(
    ("driver", "speed"), [("melfa-r3", "400"), ("melfa-datalink", "40"), ("melfa-mxt", "8")]
)
def test_the_beam_is_kept_over_the_whole_plan(driver: str, speed: str, tmp_path: Path) -> None:
    chosen = {'driver = "melfa-r3"\n': f'driver = "{driver}"\n{DOORS.get(driver, "")}'}
    if driver == "melfa-mxt":
        # The time-out counts bench time: at this speed a pause of an eighth of a second would be an alarm.
        chosen["[robot.limits_deg]"] = "[robot.settings]\nmxt_timeout_s = 20.0\n\n[robot.limits_deg]"
    with emulated(tmp_path, "--speed", speed, edit=chosen) as bench:
        run(bench.cell, tmp_path, "reflector-search", speed)
        record = run(bench.cell, tmp_path, "open-loop", speed)
    points = record.rows("points")
    lost = [event for event in record.events() if event.kind == "beam-lost"]
    print(f"\n{driver}: {len(points)} points, {len(lost)} times the beam was lost")  # noqa: T201  # the figure
    assert len(points) >= 1040
    assert not lost
