"""Monte Carlo draws of identify as a whole process: interrupted, and shared by processes and machines."""

import json
import signal
from pathlib import Path
from typing import Any

import pytest

from tests.patience import HANG_S
from tests.system.command import catseye, start
from tests.system.test_sharing import scheduler, wait_for_workers, workers
from tests.unit.app.cli.distances import write_points
from tests.unit.calibration.scara.diagnostics.bench import commands_on_nodes, measured
from tests.unit.calibration.scara.paper import random_truth

__all__ = ["scheduler", "workers"]

SMALL = ("identify", "--points", "points.csv", "--cell", "cell.toml", "--uncertainty", "monte-carlo")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    place = tmp_path / "measured"
    place.mkdir()
    write_points(measured(random_truth(4), commands_on_nodes(), noise_mm=0.01, sigma_mm=0.01, seed=4), place)
    return place


def identified(folder: Path, *arguments: str) -> dict[str, Any]:
    answer = catseye(*SMALL, "--draws", "2100", "--seed", "7", "-o", "result.json", *arguments, cwd=folder)
    assert answer.returncode == 0, answer.stderr
    document: dict[str, Any] = json.loads((folder / "result.json").read_text(encoding="utf-8"))
    del document["provenance"]["created"]
    return document


@pytest.mark.parametrize("count", ["1", "2"])
def test_ctrl_c_during_draws_exits_130_and_leaves_files_unchanged(folder: Path, count: str) -> None:
    (folder / "result.json").write_text("an earlier one", encoding="utf-8")
    before = sorted(path.name for path in folder.iterdir())
    # The first tenth takes half a second, and is reported; nine more are left to be interrupted.
    process = start(*SMALL, "--draws", "100000", "--workers", count, "-o", "result.json", cwd=folder)
    with process:
        assert process.stderr is not None
        for line in process.stderr:
            if "draws" in line:
                break
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=HANG_S)
    assert process.returncode == 130, errors
    assert "Traceback" not in errors
    assert output == ""
    assert (folder / "result.json").read_text(encoding="utf-8") == "an earlier one"
    assert sorted(path.name for path in folder.iterdir()) == before


def test_draws_shared_by_processes_are_the_same(folder: Path) -> None:
    alone = identified(folder)
    assert alone == identified(folder, "--workers", "2")
    assert alone["uncertainty"]["monte_carlo"]["draws"] == 2100


@pytest.mark.slow
@pytest.mark.usefixtures("workers")
def test_draws_over_dask_are_the_same(folder: Path, scheduler: str) -> None:
    wait_for_workers(scheduler)
    assert identified(folder) == identified(folder, "--dask", scheduler)
