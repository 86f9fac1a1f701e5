"""One terminal emulates, another examines, measures, identifies and reports: the README's way."""

import json
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from catseye.app.results.scara.result import read_result
from tests.system.command import SPEED, Emulated, catseye, emulated, last_run, only
from tests.unit.app.cli.budget_routes import EQUAL, differences

FEW_NODES = {
    "theta1_deg = [-140.0, -120.0, -100.0, -80.0, -60.0, -40.0, -20.0, 0.0, 20.0, 40.0, 60.0]": (
        "theta1_deg = [-100.0, -60.0, -20.0, 20.0]"
    ),
    "theta2_deg = [0.0, 20.0, 40.0, 60.0, 80.0, 100.0, 120.0, 140.0]": "theta2_deg = [20.0, 60.0, 100.0, 140.0]",
}


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with emulated(tmp_path_factory.mktemp("bench"), "--seed", "5") as running:
        yield running


def test_doctor_finds_every_device(bench: Emulated) -> None:
    done = catseye("doctor", bench.cell, "--json", cwd=bench.cell.parent)
    assert done.returncode == 0, done.stderr
    devices = json.loads(done.stdout)["devices"]
    assert [row["device"] for row in devices] == ["robot", "interferometer", "environment", "tracker"]
    assert all(row["ok"] and row["simulated"] for row in devices)
    assert "RH-3FRH5515" in devices[0]["identity"]
    assert "stop signals: none" in devices[0]["status"]
    assert any("MEJAR" in fact for fact in devices[0]["status"])


def test_doctor_moves_nothing_and_says_what_it_assumes(bench: Emulated) -> None:
    before = bench.ask(op="log", device="robot")["entries"]
    done = catseye("doctor", bench.cell, cwd=bench.cell.parent)
    after = bench.ask(op="log", device="robot")["entries"]
    assert [entry for entry in after if entry["kind"] == "motion"] == [
        entry for entry in before if entry["kind"] == "motion"
    ]
    assert "assumed, not checked since nothing moves: the instrument's number grows" in done.stdout


def test_doctor_says_what_to_do_about_an_alarm(bench: Emulated) -> None:
    bench.ask(op="fault", name="alarm", number=50)
    done = catseye("doctor", bench.cell, cwd=bench.cell.parent)
    bench.ask(op="fault", name="clear_faults")
    assert done.returncode == 3
    assert "alarm 50" in done.stdout
    assert "robot" in done.stderr


def test_dry_run_lists_steps_and_time_without_touching_devices(bench: Emulated) -> None:
    done = catseye("run", "open-loop", "--cell", bench.cell, "--dry-run", "--json", cwd=bench.cell.parent)
    assert done.returncode == 0, done.stderr
    table = json.loads(done.stdout)
    assert sum(step["measurements"] for step in table["steps"]) > 1000
    assert 900 < table["total_s"] < 3600
    assert "nothing was moved" in done.stderr
    moves = [entry for entry in bench.ask(op="log", device="robot")["entries"] if entry["kind"] == "motion"]
    assert moves == []


def test_from_search_to_report(tmp_path: Path) -> None:
    with emulated(tmp_path, "--seed", "5", edit={**FEW_NODES, **only("P1")}) as bench:
        measured = search_and_measure(bench)
    report_on(tmp_path, measured)
    check_files(tmp_path)


def search_and_measure(bench: Emulated) -> str:
    """Return the run of a measurement that aims from a search."""
    folder = bench.cell.parent
    searched = catseye(
        "run", "reflector-search", "--cell", bench.cell, "--speed", SPEED, "--json", cwd=folder
    )
    assert searched.returncode == 0, searched.stderr
    events = [json.loads(line) for line in searched.stdout.splitlines()]
    assert events[0]["event"] == "run-started"
    assert (events[-1]["event"], events[-1]["status"], events[-1]["exit_code"]) == (
        "run-ended",
        "complete",
        0,
    )
    measured = catseye("run", "open-loop", "--cell", bench.cell, "--speed", SPEED, cwd=folder)
    assert measured.returncode == 0, measured.stderr
    assert "aim from" in measured.stderr
    return last_run(folder, "open-loop")


def report_on(folder: Path, run: str) -> None:
    assert catseye("verify", run, cwd=folder).returncode == 0
    for command, output in (
        (["export", run, "--format", "csv"], "points.csv"),
        (["export", run, "--format", "json"], "points.json"),
        (["identify", run], "result.json"),
        (["report", run], "run.html"),
    ):
        done = catseye(*command, "-o", output, cwd=folder)
        assert done.returncode == 0, done.stderr
    again = ["identify", "--points", "points.csv", "--cell", "cell.toml", "-o", "again.json"]
    assert catseye(*again, cwd=folder).returncode == 0
    assert catseye("report", "result.json", "-o", "result.html", cwd=folder).returncode == 0


def check_files(folder: Path) -> None:
    by_value, by_u = differences(read_result(folder / "again.json"), read_result(folder / "result.json"))
    assert by_u < EQUAL
    # The run starts from the places that the search found, its table from the rough ones of the cell file. Each
    # solution ends within a step of 1e-9 mm rms: of √200 distances good to 0.01 mm that is 1.4e-6 of u.
    assert by_value < 1e-5
    for name in ("run.html", "result.html"):
        page = (folder / name).read_text()
        assert "<svg" in page
        assert not re.findall(r'(?:src|href)="https?:', page)
