"""What a run has found, whatever arm it was on: shown with its timeline, in its report and beside the run."""

from catseye.app.results.model import Section
from catseye.app.results.scara.found.sections import scara_sections
from catseye.app.results.serial_arm.run_report import serial_sections
from catseye.app.store.reader import RunReader


def found_sections(reader: RunReader) -> list[Section]:
    """Return what a run has found by itself; none where recordings or distances have to be evaluated first."""
    return [*serial_sections(reader), *scara_sections(reader)]
