"""The demonstration of six-axis calibration: an IRB 120 before a laser tracker, validated, checked by a ballbar."""

import asyncio
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any, Final

from catseye.app.cell.arm import arm_description
from catseye.app.cell.load import LoadedCell
from catseye.app.cell.templates import SIX_AXIS, TEMPLATES
from catseye.app.cli.demonstration import (
    Demonstration,
    emulators,
    interruptible,
    live_cell,
    make_folder,
    run_each,
)
from catseye.app.cli.output import note, write_document, write_line
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.engine.signals import SignalInstaller
from catseye.app.protocol.procedures import load_procedure
from catseye.app.render.page import write_page
from catseye.app.results.document import Document
from catseye.app.results.model import Report, Section
from catseye.app.results.serial_arm.ballbar_report import ballbar_section
from catseye.app.results.serial_arm.calibrate import Method, Sources, Subject, calibrate_tables
from catseye.app.results.serial_arm.calibration_document import SerialArmSummary, serial_arm_summary
from catseye.app.results.serial_arm.calibration_report import calibration_report
from catseye.app.results.serial_arm.frame_noise import with_frame_noise
from catseye.app.results.serial_arm.result import SerialArmResult, write_serial_arm
from catseye.app.results.serial_arm.run_poses import as_tables, world_covariance
from catseye.app.results.serial_arm.validation import ArmValidation, validate_arm
from catseye.app.results.serial_arm.validation_document import ArmValidationDocument, arm_validation_document
from catseye.app.results.serial_arm.validation_report import arm_validation_report
from catseye.app.store.reader import RunReader

ARM: Final = "irb120"

CELL: Final = (
    TEMPLATES[SIX_AXIS]
    .by_arm[ARM]
    .replace(
        "[tracker]\n",
        "[robot.settings]                        # a busy machine answers late\n"
        "answer_timeout_s = 5.0\ntaken_timeout_s = 20.0\n\n[tracker]\n",
        1,
    )
)
"""What `catseye init --system six-axis` writes, with time-outs, which are in real seconds, for a fast bench."""

DemoRun = tuple[str, Sequence[str]]
"""Name of a procedure, and its parameters as on the command line."""

CALIBRATION: Final[DemoRun] = ("tracker-calibration", ("count=38", "dwell_s=2", "nests_every=20"))
VALIDATION: Final[DemoRun] = (
    "tracker-validation",
    ("count=60", "dwell_s=1", "settle_s=0.3", "nests_every=30", "seed=1"),
)
BALLBAR: Final[DemoRun] = ("ballbar", ("step_deg=15",))
RUNS: Final = (CALIBRATION, VALIDATION, BALLBAR)
"""Less than the paper asks for, so that it takes a minute: shorter dwells, fewer poses to validate with."""


@dataclass(frozen=True)
class Measured:
    """What the demonstration has measured.

    Attributes:
        calibration: run of the chosen poses.
        validation: run of the random ones.
        ballbar: run of the spheres.
        result: of the calibration.
    """

    calibration: Path
    validation: Path
    ballbar: Path
    result: SerialArmResult


class ArmDemo(Document):
    """The day of a six-axis arm on an emulated bench.

    Attributes:
        runs: folders of calibration, validation and ballbar.
        result_file: the calibration.
        report: the page.
        truth: file with the true arm.
        validation: of the calibration at random poses.
        result: the calibration without descriptions and correlations.
    """

    runs: list[str]
    result_file: str
    report: str
    truth: str
    validation: ArmValidationDocument
    result: SerialArmSummary


def demonstrate_six_axis(given: Demonstration, *, as_json: bool) -> None:
    """Calibrate, validate and check an emulated arm; sum it up.

    Raises:
        DemoInterruptedError: a run did not complete.
    """
    make_folder(given.folder)
    measured = asyncio.run(measure(given))
    found = validated(measured)
    report, page = report_of(measured, found), given.folder / "report.html"
    write_page(report, page)
    if as_json:
        write_document("arm-demo", _document(given, measured, found, page))
        return
    write_tables(report)
    note_statements(report)
    write_line(f"result           {result_file(given)}")
    write_line(f"report           {page}")


async def measure(given: Demonstration, runs: tuple[DemoRun, DemoRun, DemoRun] = RUNS) -> Measured:
    """Start the emulators, measure, identify and check; keep the truth.

    Args:
        runs: for the calibration, for its validation, and with the ballbar, which takes the result.

    Raises:
        DemoInterruptedError: a run did not complete.
        InterruptedRunError: Ctrl-C between two runs.
        TerminatedRunError: SIGTERM or SIGHUP between two runs.
    """
    return await interruptible(partial(_measure, given, runs))


async def _measure(
    given: Demonstration, runs: tuple[DemoRun, DemoRun, DemoRun], install_signals: SignalInstaller
) -> Measured:
    chosen, drawn, (bar, texts) = runs
    async with emulators(given, CELL) as endpoints:
        ports = [endpoints[device] for device in ("robot", "tracker", "control")]
        cell = live_cell(given.cell_file, CELL, ports)
        run = partial(_run, given, cell, install_signals=install_signals)
        calibration = await run(chosen)
        note("identifying the arm")
        result = await asyncio.to_thread(calibrated, given, cell, calibration)
        validation = await run(drawn)
        ballbar = await run((bar, (*texts, f"result={result_file(given)}")))
        return Measured(calibration, validation, ballbar, result)


async def _run(
    given: Demonstration, cell: LoadedCell, chosen: DemoRun, *, install_signals: SignalInstaller
) -> Path:
    name, texts = chosen
    (path,) = await run_each(given, cell, [(load_procedure(name), texts)], install_signals)
    return path


def calibrated(given: Demonstration, cell: LoadedCell, run: Path) -> SerialArmResult:
    """Return what a run identifies; write it to the result file."""
    robot = cell.cell.robot
    subject = Subject(ARM, arm_description(robot.arm), robot.carried)
    reader = RunReader(run)
    with as_tables([reader]) as tables:
        found = calibrate_tables(subject, Sources(tables), Method())
    if (frame := world_covariance(reader)) is not None:
        found = with_frame_noise(found, frame)
    if found.provenance is None:
        raise TypeError("a calibration says what it was made from")
    origin = found.provenance.model_copy(update={"runs": [run.name], "simulated": True})
    result = found.model_copy(update={"provenance": origin})
    write_serial_arm(result, result_file(given))
    return result


def validated(measured: Measured) -> ArmValidation:
    """Return the calibration against the random poses."""
    reader = RunReader(measured.validation)
    with as_tables([reader]) as (table,):
        return validate_arm(measured.result, table, frame=world_covariance(reader))


def report_of(measured: Measured, found: ArmValidation) -> Report:
    """Return the report of the calibration, with validation and ballbar behind its verdict."""
    report = calibration_report("catseye demo: calibration of an emulated IRB 120", measured.result)
    validation = arm_validation_report(found, measured.validation.name, report.origin).sections
    checks: list[Section] = [*validation, ballbar_section(RunReader(measured.ballbar))]
    at = next(number for number, part in enumerate(report.sections, 1) if part.key == "verdict")
    return replace(report, sections=(*report.sections[:at], *checks, *report.sections[at:]))


def result_file(given: Demonstration) -> Path:
    """Return where the result is written."""
    return given.folder / "result.json"


def _document(given: Demonstration, measured: Measured, found: ArmValidation, page: Path) -> dict[str, Any]:
    return {
        "runs": [str(run) for run in (measured.calibration, measured.validation, measured.ballbar)],
        "result_file": str(result_file(given)),
        "report": str(page),
        "truth": str(given.truth_file),
        "validation": arm_validation_document(found).json_object(),
        "result": serial_arm_summary(measured.result),
    }
