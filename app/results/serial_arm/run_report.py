"""The report of a run on a serial arm: what it found, and how it was measured."""

from catseye.app.protocol.procedures import declared_by
from catseye.app.results.model import Report, Section
from catseye.app.results.origin import origin_now
from catseye.app.results.runs.declared_result import declared_sections
from catseye.app.results.runs.run_source import cell_of_run, origin_of_run
from catseye.app.results.runs.sections import configuration_section, incident_section, run_section
from catseye.app.results.runs.trace import sources_of, trace_section
from catseye.app.results.scara.measurement import measurement_of
from catseye.app.results.serial_arm.axis_report import axis_section
from catseye.app.results.serial_arm.ballbar_report import ballbar_section
from catseye.app.results.serial_arm.instrument_report import instrument_section
from catseye.app.results.serial_arm.poses_report import poses_section
from catseye.app.results.serial_arm.warmup_report import warmup_section
from catseye.app.store.reader import RunReader
from catseye.procedures.serial_arm.bench import SerialBench


def is_on_serial_arm(reader: RunReader) -> bool:
    """Return whether a run is one of a procedure of serial arms."""
    declared = declared_by(str(reader.meta.get("procedure")))
    return declared is not None and declared.needs.bench is SerialBench


def serial_sections(reader: RunReader) -> list[Section]:
    """Return what a run on a serial arm found; none of another run."""
    if not is_on_serial_arm(reader):
        return []
    found = (axis_section, instrument_section, warmup_section, poses_section, ballbar_section)
    return [one for section_of in found if (one := section_of(reader)).blocks]


def serial_run_report(reader: RunReader) -> Report:
    """Return the report of a run on a serial arm."""
    cell = cell_of_run(reader)
    measurement = measurement_of([reader], cell)
    sections = (
        *(serial_sections(reader) or declared_sections(reader)),
        incident_section(measurement.warnings, measurement.incidents),
        run_section(measurement, []),
        configuration_section(measurement.cell, measurement.origins),
        trace_section(origin_now().software, sources_of(), measurement.runs, ()),
    )
    title = f"{reader.meta.get('procedure')} on {cell.name}"
    return Report(title, origin_of_run(reader), sections)
