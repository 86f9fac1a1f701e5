"""The demo as a user starts it."""

import json
import signal
import subprocess
import time
from pathlib import Path

import pytest

from tests.patience import HANG_S, JOB_S
from tests.system.command import start


@pytest.mark.slow
def test_demo_does_the_whole_job(tmp_path: Path) -> None:
    with start("demo", "--out", tmp_path / "demo", "--json", cwd=tmp_path) as process:
        try:
            stdout, stderr = process.communicate(timeout=JOB_S)
        finally:
            process.kill()
    assert process.returncode == 0, stderr
    summary = json.loads(stdout)
    assert summary["validation"]["ratio"] < 0.25
    assert 0.3 < summary["rms_normalised_error"] < 1.6
    assert summary["fit"]["n_points"] > 1000
    assert summary["fit"]["lack_of_fit"]["ratio"] < 1.5
    assert "left" in stderr
    page = Path(summary["report"]).read_text(encoding="utf-8")
    assert page.count("<svg") >= 5
    assert "SIMULATION" in page
    assert Path(summary["run"], "manifest.json").is_file()


def emulators(folder: Path) -> set[str]:
    """Return the emulators that serve a bench below a folder."""
    listed = subprocess.run(["ps", "-ewwo", "pid,args"], capture_output=True, text=True, check=True).stdout
    mine = f"-m catseye emulate {folder}"
    return {line.split()[0] for line in listed.splitlines() if mine in line}


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGINT, 130)])
def test_a_demo_ended_between_runs_leaves_no_emulator(tmp_path: Path, number: int, code: int) -> None:
    process = start("demo", "--out", tmp_path / "demo", cwd=tmp_path)
    assert process.stderr is not None
    for line in process.stderr:
        if line.startswith("run complete"):
            break
    process.send_signal(number)
    if number == signal.SIGINT:
        # The first Ctrl-C may have met the next run already and holds it; the second one stops it.
        for line in process.stderr:
            if line.startswith("HELD"):
                process.send_signal(number)
                break
    _, stderr = process.communicate(timeout=HANG_S)
    assert process.returncode == code, stderr
    assert "Traceback" not in stderr
    assert not emulators(tmp_path)


def test_an_emulator_ends_with_the_demo_that_was_killed(tmp_path: Path) -> None:
    process = start("demo", "--out", tmp_path / "demo", cwd=tmp_path)
    assert process.stderr is not None
    for line in process.stderr:
        if line.startswith("reflector-search"):
            break
    assert emulators(tmp_path)
    process.kill()
    process.communicate(timeout=HANG_S)
    deadline_s = time.monotonic() + HANG_S
    while emulators(tmp_path) and time.monotonic() < deadline_s:
        time.sleep(0.1)
    assert not emulators(tmp_path)
