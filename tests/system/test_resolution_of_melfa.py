"""A run of decreasing steps on the emulated SCARA, whose controller rounds them, from the bench to its least step."""

import json
from pathlib import Path

import pytest

from tests.system.command import catseye, last_run
from tests.system.test_resolution_runs import bench

SPEED = 8.0
PARAMS = (
    'joints=["J1"]',
    'positions=["K3"]',
    "directions=[1]",
    # All sizes that rounding would repeat lie below 0.014°.
    "first_deg=0.03",
    "standstill_s=15.0",
    "dwell_s=1.5",
)


def test_steps_of_a_melfa_can_be_evaluated_to_their_end(tmp_path: Path) -> None:
    # A display that streams keeps its rate beside whatever else the machine does.
    with bench(tmp_path, 250.0, speed=SPEED, arm="rh-3frh5515") as running:
        words = ["run", "resolution", "--cell", str(running.cell), "--speed", f"{SPEED:g}"]
        words += [word for param in PARAMS for word in ("--param", param)]
        measured = catseye(*words, cwd=tmp_path)
        assert measured.returncode == 0, measured.stderr
    run = last_run(tmp_path, "resolution")
    done = catseye("resolution", run, "-o", "result.json", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    (test,) = json.loads((tmp_path / "result.json").read_text("utf-8"))["tests"]
    sizes = [abs(move["command_deg"]) for move in test["moves"]]
    # By the multiples of 0.001° that lie nearest to the paper's series, each off by half of it at most.
    assert sizes[0] == pytest.approx(0.03, abs=0.00051)
    assert sizes[-1] == pytest.approx(0.001, abs=0.00051)
    assert test["lis_deg"] is not None
