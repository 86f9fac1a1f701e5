"""The demonstration of motion resolution: a KUKA's joints, their backlash and the tool's own steps."""

import asyncio
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

from catseye.app.cli.demonstration import (
    Demonstration,
    emulated_bench,
    interruptible,
    make_folder,
    run_each,
)
from catseye.app.cli.output import note, write_json, write_line
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cli.resolution.demo_cell import CELL, emulator_cell
from catseye.app.engine.signals import SignalInstaller
from catseye.app.protocol.procedures import load_procedure
from catseye.app.render.page import write_page
from catseye.app.results.resolution.recorded_runs import result_of_runs
from catseye.app.results.resolution.result import ResolutionResult, resolution_summary, write_resolution
from catseye.app.results.resolution.result_report import resolution_report
from catseye.app.results.runs.trace import sources_of
from catseye.app.store.reader import RunReader
from catseye.calibration.resolution.decaying import THRESHOLD_PERCENT

_TIMES: Final = ("standstill_s=15", "dwell_s=1.5")

DemoRun = tuple[str, Sequence[str]]
"""Name of a procedure, and its parameters as on the command line."""

RUNS: Final[Sequence[DemoRun]] = (
    (
        "resolution",
        (*_TIMES, 'joints=["A1", "A5"]', 'positions=["K3"]', "first_deg=0.01", "steps=60"),
    ),
    (
        "resolution-iso",
        (*_TIMES, 'joints=["A1"]', 'positions=["K3"]', "amplitudes_deg=[0.002, 0.02]"),
    ),
    ("backlash", (*_TIMES, 'joints=["A5"]', 'positions=["K3"]')),
    (
        "resolution-cartesian",
        (*_TIMES, "poses_deg=[[0, -80, 80, 0, 30, 0]]", "first_mm=0.2", "steps=40"),
    ),
)
"""Less than the paper asks for, so that it takes minutes: shorter dwells, no steps far above the least one."""


def demonstrate_resolution(given: Demonstration, *, as_json: bool) -> None:
    """Measure two joints and the tool, evaluate and report; sum it up.

    Raises:
        DemoInterruptedError: a run did not complete.
    """
    make_folder(given.folder)
    runs = asyncio.run(measure(given))
    note("evaluating the recordings")
    result = evaluate(given, runs)
    report = resolution_report(
        "catseye demo: motion resolution of an emulated KUKA", [result], sources_of([result_file(given)])
    )
    page = given.folder / "report.html"
    write_page(report, page)
    if as_json:
        write_json(_document(given, runs, result, page))
        return
    write_tables(report)
    note_statements(report)
    write_line(f"result           {result_file(given)}")
    write_line(f"report           {page}")


async def measure(given: Demonstration, runs: Sequence[DemoRun] = RUNS) -> list[Path]:
    """Start the emulators, carry the runs out, keep the truth; return the run folders.

    Raises:
        DemoInterruptedError: a run did not complete.
        InterruptedRunError: Ctrl-C between two runs.
        TerminatedRunError: SIGTERM or SIGHUP between two runs.
    """
    return await interruptible(partial(_measure, given, runs))


async def _measure(
    given: Demonstration, runs: Sequence[DemoRun], install_signals: SignalInstaller
) -> list[Path]:
    chosen = [(load_procedure(name), texts) for name, texts in runs]
    async with emulated_bench(given, CELL, emulator_cell(given.speed)) as loaded:
        return await run_each(given, loaded, chosen, install_signals)


def evaluate(given: Demonstration, runs: Sequence[Path]) -> ResolutionResult:
    """Return what the runs come to; write it to the result file."""
    result = result_of_runs([RunReader(run) for run in runs], THRESHOLD_PERCENT)
    write_resolution(result, result_file(given))
    return result


def result_file(given: Demonstration) -> Path:
    """Return where the result is written."""
    return given.folder / "result.json"


def _document(
    given: Demonstration, runs: Sequence[Path], result: ResolutionResult, page: Path
) -> dict[str, Any]:
    return {
        "runs": [str(run) for run in runs],
        "result": str(result_file(given)),
        "report": str(page),
        "truth": str(given.truth_file),
        **resolution_summary(result),
    }
