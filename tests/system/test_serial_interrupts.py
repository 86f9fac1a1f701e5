"""Procedures of an emulated IRB 120 that are interrupted on the way: the arm rests, and the run goes on."""

import json
import signal
import subprocess
from collections.abc import Iterator
from typing import Any, Final

import pytest

from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from tests.system.command import Emulated, catseye, emulated, last_run, start
from tests.system.test_stop import ended, wait_for

SPEED: Final = "40"
STOP: Final = "POST /rw/rapid/execution?action=stop"

PARAMS: Final[dict[str, tuple[str, ...]]] = {
    "instrument-check": ("repeats=3", "dwell_s=2"),
    "axis-analysis": ('joints=["J2", "J4"]', "step_deg=12", "dwell_s=1"),
    "tracker-calibration": ("count=5", "candidates=60", "model=frames", "frames=true", "dwell_s=1"),
    "tracker-validation": ("count=5", "nests_every=2", "dwell_s=2"),
    "ballbar": ("nests=['nest1']", "step_deg=40"),
}
MOVING: Final = ("axis-analysis", "tracker-calibration", "tracker-validation", "ballbar")


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    folder = tmp_path_factory.mktemp("interrupts")
    text = TEMPLATES[SIX_AXIS].text + "\n[robot.settings]\nanswer_timeout_s = 5.0\ntaken_timeout_s = 20.0\n"
    with emulated(folder, "--seed", "3", "--speed", SPEED, text=text) as running:
        truth = running.ask(op="truth")
        (folder / "result.json").write_text(json.dumps(calibration_of(truth["truth"])), encoding="utf-8")
        yield running


def calibration_of(truth: dict[str, Any]) -> dict[str, Any]:
    """Return the parameters of a true arm that a calibration identifies: those of J1 and d of J3 are redundant."""
    known = (
        "alpha_deg",
        "a_mm",
        "theta_offset_deg",
        "d_mm",
        "compliance_rad_per_nmm",
        "x_mm",
        "y_mm",
        "z_mm",
    )
    kept = [
        one
        for one in truth["parameters"]
        if one["name"].startswith("base.")
        or (one["name"].endswith(known) and not one["name"].startswith(("J1.", "J3.d_mm")))
    ]
    return {"format": truth["format"], "parameters": kept}


def begun(bench: Emulated, procedure: str) -> subprocess.Popen[str]:
    params = [*PARAMS[procedure], *(["result=result.json"] if procedure == "ballbar" else [])]
    words = [word for param in params for word in ("--param", param)]
    return start(
        *("run", procedure, "--cell", str(bench.cell), "--speed", SPEED, "--json"),
        *words,
        cwd=bench.cell.parent,
    )


def is_moving(bench: Emulated) -> bool:
    return bool(bench.ask(op="arm")["moving"])


def stops(bench: Emulated) -> int:
    return sum(
        str(entry["text"]).startswith(STOP) for entry in bench.ask(op="log", device="robot")["entries"]
    )


def require_resumed(bench: Emulated, procedure: str, stderr: str, status: str) -> None:
    """The command says how to go on; what it says completes the run, and no step is done twice."""
    folder = bench.cell.parent
    run = last_run(folder, procedure)
    shown = json.loads(catseye("show", run, "--json", cwd=folder).stdout)
    assert shown["status"] == status
    assert "Traceback" not in stderr
    (said,) = [line for line in stderr.splitlines() if "catseye resume" in line and run in line]
    words = said.partition("catseye resume ")[2].split()
    done = catseye("resume", *words, "--speed", SPEED, cwd=folder)
    assert done.returncode == 0, done.stderr
    assert "aim from" not in done.stderr
    assert json.loads(catseye("show", run, "--json", cwd=folder).stdout)["status"] == "complete"


@pytest.mark.parametrize("procedure", MOVING)
def test_two_interrupts_in_motion_stop_a_run_that_resumes(bench: Emulated, procedure: str) -> None:
    before = stops(bench)
    process = begun(bench, procedure)
    wait_for(process, "step-started")
    while not is_moving(bench):
        assert process.poll() is None
    process.send_signal(signal.SIGINT)
    wait_for(process, "HELD")
    assert not is_moving(bench)
    process.send_signal(signal.SIGINT)
    code, stderr = ended(process)
    assert code == 130, stderr
    assert stops(bench) > before
    assert not is_moving(bench)
    require_resumed(bench, procedure, stderr, "stopped")


@pytest.mark.parametrize("procedure", PARAMS)
def test_a_termination_after_a_step_aborts_a_run_that_resumes(bench: Emulated, procedure: str) -> None:
    before = stops(bench)
    process = begun(bench, procedure)
    wait_for(process, "step-done")
    process.send_signal(signal.SIGTERM)
    code, stderr = ended(process)
    assert code == 143, stderr
    assert stops(bench) > before
    assert not is_moving(bench)
    require_resumed(bench, procedure, stderr, "aborted")


@pytest.mark.parametrize("procedure", PARAMS)
def test_an_interrupt_while_devices_connect_moves_nothing(bench: Emulated, procedure: str) -> None:
    place = bench.ask(op="arm")["joints"]
    process = begun(bench, procedure)
    wait_for(process, "run-started")
    process.send_signal(signal.SIGINT)
    code, stderr = ended(process)
    assert code == 130, stderr
    assert bench.ask(op="arm")["joints"] == place
    require_resumed(bench, procedure, stderr, "stopped")
