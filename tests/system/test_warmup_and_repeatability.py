"""Warm-up and repeatability headless on the emulated bench, with the searched aim, and rehearsed."""

import asyncio
from pathlib import Path
from typing import Any

import pytest

from catseye.app.cell.load import load_cell
from catseye.app.protocol.procedures import load_procedure, parse_params
from catseye.app.service.running import plan_run, rehearse
from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader
from tests.system.command import Emulated, catseye, emulated, last_run


def run(cell: Path, folder: Path, procedure: str, *options: str) -> tuple[int, str]:
    params = [text for option in options for text in ("--param", option)]
    done = catseye("run", procedure, "--cell", cell, "--speed", "400", *params, cwd=folder)
    return done.returncode, done.stderr


def reader(folder: Path, procedure: str) -> RunReader:
    return RunReader(resolve_run(folder / "catseye-runs", last_run(folder, procedure)))


def analysed(found: RunReader) -> dict[str, Any]:
    (step,) = (step for step in found.steps() if step.step_id == "analyse")
    assert step.result is not None
    return dict(step.result)


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Any:
    folder = tmp_path_factory.mktemp("warm")
    with emulated(folder) as emulator:
        code, output = run(emulator.cell, folder, "reflector-search", "poses=4")
        assert code == 0, output
        yield emulator, folder


def test_warmup_ends_when_the_drift_is_small(bench: tuple[Emulated, Path]) -> None:
    emulator, folder = bench
    short = (
        "window_min=0.5",
        "cycle_min=0.05",
        "checks=1",
        "amplitude_share=0.15",
        "limit_um_per_10min=1000.0",
    )
    code, output = run(emulator.cell, folder, "warmup", *short)
    assert code == 0, output
    found = reader(folder, "warmup")
    verdict, rows = analysed(found), found.records("drift")
    assert verdict["warm"] is True
    assert len(rows) == verdict["visits"] >= 6
    assert {row["segment"] for row in rows} == {0}
    # The arm's arrivals scatter by 10 µm; nothing else moves the distance by more.
    values_um = [1e3 * float(str(row["displacement_mm"])) for row in rows]
    assert 0.5 < max(values_um) - min(values_um) < 80.0


def test_an_unfinished_warmup_is_rejected_with_the_remedy(bench: tuple[Emulated, Path]) -> None:
    emulator, folder = bench
    short = ("window_min=0.5", "cycle_min=0.05", "duration_limit_min=1", "amplitude_share=0.15", "checks=1")
    code, output = run(emulator.cell, folder, "warmup", "limit_um_per_10min=0.1", *short)
    assert code == 1, output
    assert "longer" in output or "larger limit" in output
    assert analysed(reader(folder, "warmup"))["warm"] is False


def test_repeatability_finds_the_scatter_of_the_emulated_arm(bench: tuple[Emulated, Path]) -> None:
    emulator, folder = bench
    poses = "poses=[[-20.0, 80.0], [0.0, 100.0]]"
    code, output = run(emulator.cell, folder, "repeatability", poses, "cycles=8", 'reflectors=["P1", "P3"]')
    assert code == 0, output
    found = reader(folder, "repeatability")
    result = analysed(found)
    assert len(found.records("repeat")) == 2 * 2 * 8
    # Four standard deviations of 7 degrees of freedom each: together 10 µm within 4 · 10 / sqrt(2 · 28).
    mean_square = sum(row["s_um"] ** 2 for row in result["beams"]) / 4
    assert mean_square**0.5 == pytest.approx(10.0, abs=5.3)
    assert [row["dof"] for row in result["beams"]] == [7] * 4
    for row in result["positions"]:
        assert "refused" in row or "roundest" in row["assumption"]


@pytest.mark.parametrize(
    ("procedure", "params"),
    [("warmup", ["window_min=6", "amplitude_share=0.2"]), ("repeatability", ["cycles=2", "poses=3"])],
)
def test_both_can_be_rehearsed(
    bench: tuple[Emulated, Path], procedure: str, params: list[str], tmp_path: Path
) -> None:
    runnable = load_procedure(procedure)
    chosen = parse_params(runnable.params_type, params)
    planned = plan_run(load_cell(bench[0].cell), runnable, chosen, tmp_path, "none")
    rehearsed = asyncio.run(rehearse(planned))
    assert rehearsed.steps[-1].step_id == "analyse"
    assert not rehearsed.prompts
    assert not [data for kind, data in rehearsed.notes if kind == "beam-lost"]
    expected_s = {"warmup": 60.0 * 6, "repeatability": getattr(planned.plan, "duration_s", 0.0)}[procedure]
    assert rehearsed.total_s == pytest.approx(
        expected_s, rel=0.2, abs=180.0 if procedure == "warmup" else 5.0
    )
