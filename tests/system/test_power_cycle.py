"""Runs in whose middle a device loses its power: they stop, say what is to be done, and go on when it is done."""

import subprocess
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from tests.patience import HANG_S
from tests.system.command import Emulated, catseye, emulated, only, own_runtime
from tests.system.kuka_kills import FEW
from tests.system.makes import MAKES

VALIDATION = ("tracker-validation", "--param", "count=4", "--param", "nests_every=2", "--param", "dwell_s=2")
SLOWLY, SPEED = "20", "100"
"""Of the bench: slowly while something is waited for, and the power is cut."""

OFF_S = 120.0
WARM_AGAIN_S = 300.0
FAILED, ABORTED = 3, 5


def motions(bench: Emulated) -> list[str]:
    """Return what the arm was commanded so far."""
    entries = bench.ask(op="log", device="robot")["entries"]
    return [entry["text"] for entry in entries if entry["kind"] == "motion"]


def interrupted(
    bench: Emulated, device: str, folder: Path, *words: str, when: Callable[[], bool]
) -> subprocess.CompletedProcess[str]:
    """Run a procedure slowly, and take a device's power once something is the case; return how it ended."""
    with ThreadPoolExecutor(1) as pool:
        run = pool.submit(catseye, "run", *words, "--cell", bench.cell, "--speed", SLOWLY, cwd=folder)
        until_s = time.monotonic() + HANG_S
        while not when() and not run.done() and time.monotonic() < until_s:
            time.sleep(0.02)
        assert not run.done(), run.result().stderr
        bench.ask(op="fault", name="cut_power", device=device, duration_s=OFF_S)
        ended = run.result()
    bench.ask(op="speed", value=float(SPEED))
    return ended


def require_ended(done: subprocess.CompletedProcess[str], device: str, *causes: str) -> None:
    """Check that a run ended and named the cause: a link that is healed in time shows the state of the device."""
    assert device in done.stderr, done.stderr
    assert done.returncode in {FAILED, ABORTED}, done.stderr
    assert any(cause in done.stderr for cause in causes), done.stderr


def moved(bench: Emulated, count: int) -> Callable[[], bool]:
    """Return a look whether the arm has begun to move so many times."""
    return lambda: sum(not text.startswith("arrival") for text in motions(bench)) >= count


def wait_for_power(bench: Emulated, longer_s: float = 0.0) -> None:
    """Wait until every device has its power again, and longer if need be."""
    until_s = float(bench.ask(op="arm")["time_s"]) + OFF_S + longer_s
    while float(bench.ask(op="arm")["time_s"]) < until_s:
        time.sleep(0.05)


def stands_still(bench: Emulated) -> None:
    """Check that nothing has moved since the power came back."""
    before = bench.ask(op="arm")
    wait_for_power(bench)
    after = bench.ask(op="arm")
    assert after["joints"] == before["joints"]
    assert not after["servo"]


def measures_again(bench: Emulated, folder: Path, *words: str) -> None:
    """Check that the same run, begun anew, is complete."""
    again = catseye("run", *words, "--cell", bench.cell, "--speed", SPEED, cwd=folder)
    assert again.returncode == 0, again.stderr


def test_a_run_without_a_robots_power_ends_and_begins_anew(tmp_path: Path) -> None:
    text = TEMPLATES[SIX_AXIS].text
    with own_runtime(), emulated(tmp_path, "--seed", "3", "--speed", SLOWLY, text=text) as bench:
        done = interrupted(bench, "robot", tmp_path, *VALIDATION, when=moved(bench, 2))
        require_ended(done, "robot", "power", "the drives are off: find out why")
        stands_still(bench)
        measures_again(bench, tmp_path, *VALIDATION)


def test_a_run_without_a_trackers_power_ends_and_begins_anew(tmp_path: Path) -> None:
    text = TEMPLATES[SIX_AXIS].text
    with own_runtime(), emulated(tmp_path, "--seed", "3", "--speed", SLOWLY, text=text) as bench:
        done = interrupted(bench, "tracker", tmp_path, *VALIDATION, when=moved(bench, 2))
        require_ended(done, "tracker", "power", "let it warm up")
        wait_for_power(bench, WARM_AGAIN_S)
        measures_again(bench, tmp_path, *VALIDATION)


def test_a_search_without_a_melfas_power_ends_and_begins_anew(tmp_path: Path) -> None:
    with own_runtime(), emulated(tmp_path, "--speed", SLOWLY, edit=only("P1")) as bench:
        done = interrupted(bench, "robot", tmp_path, "reflector-search", when=moved(bench, 2))
        require_ended(done, "robot", "power", "the drives are off: find out why")
        stands_still(bench)
        measures_again(bench, tmp_path, "reflector-search")


def test_a_resolution_test_without_a_kukas_power_needs_its_program(tmp_path: Path) -> None:
    text = MAKES["kuka"].example.read_text(encoding="utf-8")
    words = ("resolution", *(word for param in FEW for word in ("--param", param)))
    with own_runtime(), emulated(tmp_path, "--speed", SLOWLY, text=text) as bench:
        done = interrupted(bench, "robot", tmp_path, *words, when=moved(bench, 2))
        require_ended(done, "robot", "power", "smartPAD", "the drives are off: find out why")
        stands_still(bench)
        unmet = catseye("run", *words, "--cell", bench.cell, "--speed", SPEED, cwd=tmp_path)
        assert unmet.returncode != 0
        assert "smartPAD" in unmet.stderr
        for key in ("drives", "reset", "start"):
            bench.ask(op="press", key=key)
        measures_again(bench, tmp_path, *words)
