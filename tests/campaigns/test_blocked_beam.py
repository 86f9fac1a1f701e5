"""A beam that is blocked at 20 random moments of the paper's plan: all recovered, no wrong point, an honest map."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from catseye.app.cell.load import load_cell
from catseye.app.results.scara.identify import bench_of_runs, identify_points, run_points
from catseye.app.results.scara.measured_distances import measured_distances
from catseye.app.results.scara.truth import compare_with_truth
from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader
from tests.system.blocking import Story, misfits_um, random_blocks, run_blocked, still_truth
from tests.system.command import catseye, emulated, last_run

_SPEED = "100"
_BLOCKS = 20
_POINTS = 1048
_CLOSURES = 6
_PLACES = {"P1": (650.0, -400.0), "P2": (680.0, 0.0), "P3": (640.0, 380.0)}


def stored(folder: Path) -> RunReader:
    return RunReader(resolve_run(folder / "catseye-runs", last_run(folder, "open-loop")))


def require_all_recovered(story: Story, record: RunReader, blocks: int) -> None:
    """Every point is there, and every block was noticed."""
    assert story.code == 0, story.stderr
    points, events = record.rows("points"), record.events()
    lost = [event for event in events if event.kind == "beam-lost"]
    causes = [event.data["cause"] for event in lost]
    segments = {(point["reflector"], point["segment"]) for point in points}
    asked = [prompt for prompt in record.prompts() if str(prompt["id"]).startswith("beam/")]
    by_cause = {cause: causes.count(cause) for cause in set(causes)}
    print(  # noqa: T201  # the figure
        f"\n{len(points)} points, {blocks} blocks, {len(lost)} losses {by_cause}, {len(asked)} questions, "
        f"{len(record.records('overlap'))} overlaps, {len(segments)} segments, "
        f"{len(record.records('closure'))} closures"
    )
    assert len(points) == _POINTS
    assert (
        len(
            {
                (p["reflector"], p["theta1_deg"], p["theta2_deg"], p["direction1"], p["direction2"])
                for p in points
            }
        )
        == _POINTS
    )
    assert not [event for event in events if event.kind == "point-left-out"]
    # A block that falls between two looks of a count that is not in use spoils nothing and is not reported.
    assert len(lost) >= blocks - 3


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("seed", [1, 2])
def test_not_one_fringe_is_miscounted(seed: int, tmp_path: Path) -> None:
    truth = still_truth(tmp_path, _PLACES)
    options = ("--speed", _SPEED, "--truth", str(truth))
    with emulated(tmp_path, *options, module="tests.system.still_bench") as bench:
        blocks = random_blocks(seed, _BLOCKS, _POINTS + _CLOSURES, lasting=4)
        story = run_blocked(bench, blocks, _SPEED, "--search", "none")
        arm: dict[str, Any] = bench.ask(op="truth")["truth"]
    record = stored(tmp_path)
    require_all_recovered(story, record, _BLOCKS)
    off = np.abs(misfits_um(measured_distances(record), arm))
    print(f"largest misfit {off.max():.3f} µm; a fringe is 0.32 µm, a lost count up to millimetres")  # noqa: T201  # the figure
    assert off.max() < 0.3


@pytest.mark.timeout(1800)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_the_map_stays_within_its_own_uncertainty(seed: int, tmp_path: Path) -> None:
    with emulated(tmp_path, "--speed", _SPEED, "--seed", str(seed)) as bench:
        searched = catseye("run", "reflector-search", "--cell", bench.cell, "--speed", _SPEED, cwd=tmp_path)
        assert searched.returncode == 0, searched.stderr
        blocks = random_blocks(seed, _BLOCKS, _POINTS + _CLOSURES, lasting=4)
        story = run_blocked(bench, blocks, _SPEED)
        arm: dict[str, Any] = bench.ask(op="truth")["truth"]
    record = stored(tmp_path)
    require_all_recovered(story, record, _BLOCKS)
    cell = load_cell(bench.cell).cell
    sigma_um = cell.uncertainty.distance_um
    off = np.abs(misfits_um(record.rows("points"), arm))
    rows, folder = run_points([record]), tmp_path / "catseye-runs"
    found = identify_points(rows, bench_of_runs([record], folder), "error-map", cell.uncertainty.budget)
    compared = compare_with_truth(found, arm)
    print(  # noqa: T201  # the figure
        f"largest misfit {off.max():.1f} µm (5 sigma = {5 * sigma_um:.1f} µm); normalised errors "
        f"{compared.rms_normalised:.2f} rms, largest {np.abs(compared.normalised).max():.1f}"
    )
    assert off.max() < 5.0 * sigma_um
    # The errors of one arm are strongly correlated by the radial error motions: by the correlation matrix R of this
    # layout n² / |R|² = 3.6 of them are independent. The rms of so many lies between 0.24 and 1.87 in 98 of 100 arms
    # (chi-square); that it is 1 in the mean is shown over 60 arms by tests/benchmarks/test_accuracy.py.
    assert 0.24 < compared.rms_normalised < 1.87
