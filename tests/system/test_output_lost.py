"""Runs whose stdout is closed, full, or read by nobody: what is told is not what is measured."""

import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import IO, Any

import pytest

from catseye.app.store.catalog import list_runs, resolve_run
from catseye.app.store.reader import RunReader
from tests.patience import HANG_S
from tests.system import forked
from tests.system.command import SPEED, Emulated, catseye, emulated, environment


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Emulated]:
    with emulated(tmp_path_factory.mktemp("output"), "--seed", "3") as running:
        yield running


def ended(bench: Emulated, folder: Path, out: IO[Any], err: IO[Any], cell: Path | None = None) -> int:
    """Return how a search with this stdout ended."""
    words: list[str | Path] = [
        "run",
        "reflector-search",
        "--cell",
        cell or bench.cell,
        "--speed",
        SPEED,
        "--json",
        "--runs",
        "runs",
    ]
    return forked.Forked("catseye", words, cwd=folder, env=environment(), out=out, err=err).wait(HANG_S)


def stored(folder: Path) -> dict[str, Any]:
    """Return the events of the only run by their kinds."""
    (run,) = list_runs(folder / "runs")
    return {
        event.kind: event.data for event in RunReader(resolve_run(folder / "runs", run.path.name)).events()
    }


def test_a_run_goes_on_on_a_full_disk(bench: Emulated, tmp_path: Path) -> None:
    with open("/dev/full", "wb") as full, tempfile.TemporaryFile() as said:
        assert ended(bench, tmp_path, full, said) == 0
    events = stored(tmp_path)
    assert events["output-lost"] == {"reason": events["output-lost"]["reason"], "policy": "go-on"}
    assert "No space left on device" in events["output-lost"]["reason"]
    assert events["run-ended"]["status"] == "complete"


def test_a_run_goes_on_in_a_closed_pipe(bench: Emulated, tmp_path: Path) -> None:
    source, sink = os.pipe()
    os.close(source)
    with open(sink, "wb") as closed:
        # stderr is the same pipe, as with `2>&1 | head`.
        assert ended(bench, tmp_path, closed, closed) == 0
    assert stored(tmp_path)["output-missed"]["events"] > 1


def test_a_run_does_not_wait_for_its_reader(bench: Emulated, tmp_path: Path) -> None:
    source, sink = os.pipe()
    # It holds less than a run says, and nobody reads it.
    os.set_blocking(sink, False)
    try:
        while True:
            os.write(sink, b" " * 4096)
    except BlockingIOError:
        os.set_blocking(sink, True)
    with open(sink, "wb") as full:
        assert ended(bench, tmp_path, full, full) == 0
    os.close(source)
    assert stored(tmp_path)["run-ended"]["status"] == "complete"


def test_a_held_run_without_readers_stops_and_resumes(bench: Emulated, tmp_path: Path) -> None:
    text, cell = bench.cell.read_text(encoding="utf-8"), tmp_path / "cell.toml"
    assert "\nhold_limit_s = 900 " in text
    holds = text.replace("\nhold_limit_s = 900 ", '\non_output_lost = "hold"\nhold_limit_s = 1 ')
    cell.write_text(holds, encoding="utf-8")
    source, sink = os.pipe()
    os.close(source)
    with open(sink, "wb") as closed:
        assert ended(bench, tmp_path, closed, closed, cell) == 4
    events = stored(tmp_path)
    assert events["output-lost"]["policy"] == "hold"
    assert (events["run-ended"]["status"], events["run-ended"]["exit_code"]) == ("stopped", 4)
    assert "for 1 s ([engine] hold_limit_s)" in events["run-ended"]["text"]
    (run,) = list_runs(tmp_path / "runs")
    before = RunReader(run.path).count("steps")
    resumed = catseye("resume", run.name, "--runs", "runs", "--json", cwd=tmp_path)
    assert resumed.returncode == 0, resumed.stderr
    reader = RunReader(run.path)
    assert reader.status == "complete"
    assert reader.count("steps") > before
