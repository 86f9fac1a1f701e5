"""Stopping a run from outside: the ladder's exit codes, with the controller's own log as witness."""

import json
import signal
import subprocess
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from tests.system.blocking import still_truth
from tests.system.command import Emulated, catseye, emulated, last_run, start

SLOW = "40"


@pytest.fixture
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    folder = tmp_path_factory.mktemp("stop")
    truth = still_truth(folder, {"P1": (650.0, -400.0), "P2": (680.0, 0.0), "P3": (640.0, 380.0)})
    with emulated(folder, "--speed", SLOW, "--truth", str(truth)) as running:
        yield running


def running(bench: Emulated) -> subprocess.Popen[str]:
    """Start a measurement and return when its first points are stored."""
    arguments = ["--cell", str(bench.cell), "--search", "none", "--speed", SLOW, "--json"]
    process = start("run", "open-loop", *arguments, cwd=bench.cell.parent)
    wait_for(process, "step-done")
    return process


def wait_for(process: subprocess.Popen[str], event: str) -> dict[str, Any]:
    assert process.stdout is not None
    for line in process.stdout:
        message: dict[str, Any] = json.loads(line)
        if message["event"] == event or message.get("state") == event:
            return message
    raise AssertionError(f"the run ended without {event}")


def ended(process: subprocess.Popen[str]) -> tuple[int, str]:
    watchdog = threading.Timer(60, process.kill)
    watchdog.start()
    _, stderr = process.communicate()
    watchdog.cancel()
    watchdog.join()
    return process.returncode, stderr


def status_of(bench: Emulated) -> str:
    folder = bench.cell.parent
    shown = catseye("show", last_run(folder, "open-loop"), "--json", cwd=folder)
    return str(json.loads(shown.stdout)["status"])


def stops(bench: Emulated) -> int:
    entries = bench.ask(op="log", device="robot")["entries"]
    return sum("STOP" in entry["text"].upper() for entry in entries if entry["kind"] == "request")


def test_first_interrupt_holds_second_stops(bench: Emulated) -> None:
    process = running(bench)
    process.send_signal(signal.SIGINT)
    wait_for(process, "HELD")
    assert bench.ask(op="state")["moving"] is False
    process.send_signal(signal.SIGINT)
    code, stderr = ended(process)
    assert code == 130, stderr
    assert status_of(bench) == "stopped"
    assert stops(bench) >= 1
    assert bench.ask(op="state")["moving"] is False


def test_termination_aborts(bench: Emulated) -> None:
    process = running(bench)
    process.send_signal(signal.SIGTERM)
    code, stderr = ended(process)
    assert code == 143, stderr
    assert status_of(bench) == "aborted"
    assert stops(bench) >= 1
    assert bench.ask(op="state")["moving"] is False


def test_alarm_aborts_with_the_remedy(bench: Emulated) -> None:
    process = running(bench)
    bench.ask(op="fault", name="emergency_stop", on=True)
    code, stderr = ended(process)
    assert code == 5, stderr
    assert "mergency stop" in stderr
    assert status_of(bench) == "aborted"


def test_pulled_cable_fails_and_names_the_device(bench: Emulated) -> None:
    process = running(bench)
    bench.process.kill()
    code, stderr = ended(process)
    # Standstill cannot be confirmed over a dead link: that is a safety ending, and it says so.
    assert code in (3, 5), stderr
    assert "127.0.0.1" in stderr
    assert "Traceback" not in stderr
