"""The demonstration of motion resolution: joints of a KUKA, their backlash, and the steps of its tool."""

import asyncio
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, Final

from catseye.app.cell.load import load_cell
from catseye.app.cli.demonstration import (
    DemoInterruptedError,
    Demonstration,
    emulated_bench,
    interruptible,
    make_folder,
    run_each,
)
from catseye.app.cli.output import note, warn, write_document, write_line
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cli.resolution.demo_cell import ARM, CELL, emulator_cell
from catseye.app.cli.resolution.demo_prediction import predict_tool
from catseye.app.cli.resolution.demo_truth import TrueLeastStep, compare_with_truth, truth_section
from catseye.app.cluster.sharing import sharing
from catseye.app.engine.signals import SignalInstaller
from catseye.app.errors import UsageError
from catseye.app.protocol.procedures import load_procedure
from catseye.app.render.page import write_page
from catseye.app.results.model import Report
from catseye.app.results.resolution.documents import resolution_summary
from catseye.app.results.resolution.recorded_runs import result_of_runs
from catseye.app.results.resolution.recorded_series import series_of_run
from catseye.app.results.resolution.result import (
    AnyTest,
    ResolutionResult,
    write_resolution,
)
from catseye.app.results.resolution.result_report import resolution_files_report
from catseye.app.results.resolution.shipped import shipped_results
from catseye.app.service.emulated_arm import emulation_config
from catseye.app.store.reader import RunReader
from catseye.calibration.resolution.decaying import THRESHOLD_PERCENT
from catseye.calibration.resolution.errors import MovesError

_ONE_A_CORE: Final = 0
"""Processes that models and figures are shared between: nothing else is left to do meanwhile."""

_TIMES: Final = ("standstill_s=15", "dwell_s=1")

POSE_DEG: Final = (0.0, -80.0, 80.0, 0.0, 30.0, 0.0)
"""Of the Cartesian test."""

DemoRun = tuple[str, Sequence[str]]
"""Name of a procedure, and its parameters as on the command line."""

RUNS: Final[Sequence[DemoRun]] = (
    ("resolution", (*_TIMES, 'joints=["A1"]', 'positions=["K3"]', "first_deg=0.003", "steps=50")),
    ("resolution", (*_TIMES, 'joints=["A5"]', 'positions=["K3"]', "first_deg=0.012", "steps=36")),
    ("resolution-iso", (*_TIMES, 'joints=["A1"]', 'positions=["K3"]', "amplitudes_deg=[0.0005, 0.005]")),
    ("backlash", (*_TIMES, 'joints=["A1"]', 'positions=["K3"]')),
    (
        "resolution-cartesian",
        (*_TIMES, f"poses_deg=[{list(POSE_DEG)}]", "first_mm=0.03", "steps=34"),
    ),
)
"""Less than the paper asks for, so that it takes a minute: shorter dwells, no steps far above the least one."""


def demonstrate_resolution(given: Demonstration, *, as_json: bool) -> None:
    """Measure two joints and the tool, evaluate and report; sum it up.

    Raises:
        DemoInterruptedError: a run did not complete.
    """
    make_folder(given.folder)
    try:
        runs = asyncio.run(measure(given))
    except DemoInterruptedError as ended:
        if ended.outcome.status != "failed":
            raise
        raise DemoInterruptedError(ended.outcome, _slower(given)) from ended
    note("evaluating the recordings")
    result = evaluate(given, runs)
    with sharing(_ONE_A_CORE, None) as share:
        note("predicting the steps of the tool from those of the joints")
        predicted = predict_tool(given.folder, ARM, POSE_DEG, [result, other_cells(result)], share)
        note("repeating the steps on the emulated arm without an interferometer")
        truth = compared_with_truth(given, runs, result)
        note("drawing the figures of the report")
        report, page = report_of(given, truth, predicted), given.folder / "report.html"
        write_page(report, page, share)
    if as_json:
        write_document("resolution-demo", _document(given, runs, result, truth, page))
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
    """Return what the runs come to; write it to the result file.

    Raises:
        UsageError: a recording does not fit its moves, as when the emulators cannot keep up.
    """
    try:
        result = result_of_runs([RunReader(run) for run in runs], THRESHOLD_PERCENT)
    except MovesError as error:
        raise UsageError(f"{error}. {_slower(given)}") from error
    if result.refused:
        warn(f"{len(result.refused)} of the recordings could not be evaluated. {_slower(given)}")
    write_resolution(result, result_file(given))
    write_resolution(other_cells(result), shipped_file(given))
    return result


def _slower(given: Demonstration) -> str:
    return (
        f"A busy computer cannot keep emulators at {given.speed:g} times real speed, and their time then falls "
        f"behind that of the moves: call again with --speed {max(1.0, given.speed / 3.0):.2g}"
    )


def other_cells(measured: ResolutionResult) -> ResolutionResult:
    """Return the tests that come with the program, but for those that were measured.

    Raises:
        UsageError: a shipped file is no result: the installation is damaged.
    """
    shipped = shipped_results(ARM)
    own = {_cell_of(test) for test in measured.tests}
    tests = [test for one in shipped for test in one.tests if _cell_of(test) not in own]
    return shipped[0].model_copy(update={"arm": measured.arm, "actuation": [], "tests": tests})


def _cell_of(test: AnyTest) -> tuple[object, ...]:
    """Return where a test stands in the tables of the report."""
    return test.test, test.joint, test.position, test.direction


def compared_with_truth(
    given: Demonstration, runs: Sequence[Path], result: ResolutionResult
) -> list[TrueLeastStep]:
    """Return the least steps that were found beside those of the emulated arm."""
    arm = emulation_config(load_cell(given.cell_file).cell, given.speed, given.seed, None).serial
    if arm is None:
        raise TypeError("the bench of the demonstration carries no serial arm")
    configurations = [series.configuration for run in runs for series in series_of_run(RunReader(run))]
    return compare_with_truth(result.tests, configurations, arm, given.truth_file)


def report_of(given: Demonstration, truth: Sequence[TrueLeastStep], predicted: Sequence[Path] = ()) -> Report:
    """Return the report of the result, with the emulated arm's own least steps behind the verdict.

    Args:
        truth: the emulated arm's least steps.
        predicted: files with what is predicted for the tool.
    """
    report = resolution_files_report([result_file(given), shipped_file(given), *predicted])
    at = next(number for number, part in enumerate(report.sections, 1) if part.key == "verdict")
    sections = (*report.sections[:at], truth_section(truth), *report.sections[at:])
    return replace(report, title=f"catseye demo: {report.title}", sections=sections)


def result_file(given: Demonstration) -> Path:
    """Return where the result is written."""
    return given.folder / "result.json"


def shipped_file(given: Demonstration) -> Path:
    """Return where the tests are written that come with the program."""
    return given.folder / "shipped.json"


def _document(
    given: Demonstration,
    runs: Sequence[Path],
    result: ResolutionResult,
    truth: Sequence[TrueLeastStep],
    page: Path,
) -> dict[str, Any]:
    return {
        "runs": [str(run) for run in runs],
        "result_file": str(result_file(given)),
        "shipped": str(shipped_file(given)),
        "report": str(page),
        "truth": str(given.truth_file),
        "least_steps": [one.json_object() for one in truth],
        "result": resolution_summary(result),
    }
