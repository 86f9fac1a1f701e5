"""A program that is killed leaves its arm on the way: whoever resumes waits until it stands."""

import json
import signal
from pathlib import Path

from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader
from tests.system.command import begun, catseye, emulated, last_run
from tests.system.door_openings import SLOW

_SPEED = "5"


def test_a_resume_does_not_drive_into_a_moving_arm(tmp_path: Path) -> None:
    with emulated(tmp_path, "--speed", _SPEED, edit=SLOW) as bench:
        options = ["--speed", _SPEED, "--search", "none", "--json", "--param", 'reflectors=["P2"]']
        with begun("run", "open-loop", "--cell", bench.cell, *options, cwd=tmp_path) as (process, output):
            while json.loads(output.readline())["event"] != "step-done":
                pass
            while not bench.ask(op="state")["moving"]:
                pass
            process.send_signal(signal.SIGKILL)
            process.wait(10)
        run = last_run(tmp_path, "open-loop")
        resumed = catseye("resume", run, cwd=tmp_path)
        while "is in use by process" in resumed.stderr:
            # The guard of the killed program stops the arm, and owns it until that is done.
            resumed = catseye("resume", run, cwd=tmp_path)
    assert resumed.returncode == 0, resumed.stderr
    assert "first motion: from" in resumed.stderr
    record = RunReader(resolve_run(tmp_path / "catseye-runs", run))
    (ready,) = [event for event in record.events() if event.kind == "ready"][1:]
    (first,) = [event for event in record.events() if event.kind == "first-motion"][1:]
    # The way begins where the arm was seen to stand.
    assert first.data["stands"] == ready.data["joints"]
    assert len(record.rows("points")) == 16 + 2
