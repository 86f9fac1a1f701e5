"""What a run has found, whatever arm it was on: shown with its timeline, in its report and beside the run."""

from catseye.app.results.model import Section, Sign, Statement, section
from catseye.app.results.resolution.recorded_runs import holds_tests
from catseye.app.results.resolution.result_report import resolution_run_report
from catseye.app.results.runs.declared_result import declared_sections
from catseye.app.results.scara.found.sections import scara_sections
from catseye.app.results.serial_arm.run_report import serial_sections
from catseye.app.store.reader import RunReader
from catseye.calibration.core.errors import CalibrationError


def found_sections(reader: RunReader) -> list[Section]:
    """Return what a run has found by itself; none where distances have to be identified first."""
    if holds_tests(reader):
        return _resolution_sections(reader)
    return [*serial_sections(reader), *scara_sections(reader)] or declared_sections(reader)


def _resolution_sections(reader: RunReader) -> list[Section]:
    """Return verdict and tables of recorded steps, or why they cannot be evaluated."""
    try:
        report = resolution_run_report(reader)
    except CalibrationError as error:
        said = Statement(Sign.BAD, f"The recordings cannot be evaluated: {error}")
        return [section("verdict", "Verdict", [said], brief=True)]
    return [one for one in report.sections if one.brief]
