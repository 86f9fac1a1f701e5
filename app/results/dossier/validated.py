"""A result against the run that it was validated on, as `catseye validate RESULT --measured RUN` compares them."""

from dataclasses import replace
from pathlib import Path

from catseye.app.errors import UsageError
from catseye.app.results.dossier.worth import Worth
from catseye.app.results.model import Report, Statement
from catseye.app.results.origin import joined
from catseye.app.results.runs.run_source import origin_of_run
from catseye.app.results.scara.distance_report import distance_statement
from catseye.app.results.scara.path_as_file import path_as_file
from catseye.app.results.scara.validation_of_files import file_validation_report, validate_files
from catseye.app.results.scara.validation_of_run import (
    conventional_beside,
    distance_report,
    has_distances,
    validate_run,
)
from catseye.app.results.scara.validation_text import path_statement
from catseye.app.results.serial_arm.result import is_of_serial_arm, read_serial_arm
from catseye.app.results.serial_arm.run_poses import as_tables, world_covariance
from catseye.app.results.serial_arm.validation import validate_arm
from catseye.app.results.serial_arm.validation_report import arm_validation_report
from catseye.app.store.reader import RunReader


def worth_of_validation(result: Path, reader: RunReader) -> Worth:
    """Return what a result leaves on a run.

    Raises:
        CalibrationError: too little of the run can be compared.
        UsageError: the run does not belong to the result.
    """
    if is_of_serial_arm(result):
        return _on_poses(result, reader)
    return _on_distances(result, reader) if has_distances(reader) else _on_positions(result, reader)


def _on_poses(result: Path, reader: RunReader) -> Worth:
    identified = read_serial_arm(result)
    origin = joined([identified.origin, origin_of_run(reader)])
    with as_tables([reader]) as (table,):
        found = validate_arm(identified, table, frame=world_covariance(reader))
        report = arm_validation_report(found, reader.name, origin)
    return _worth(report, report.statements()[0], "validation")


def _on_distances(result: Path, reader: RunReader) -> Worth:
    found = validate_run(result, reader)
    if found.distances is None:
        raise UsageError(f"{reader.name} holds no distances along a path")
    return _worth(distance_report(found, reader), distance_statement(found.distances), "validation-distances")


def _on_positions(result: Path, reader: RunReader) -> Worth:
    with path_as_file(reader) as measured:
        # Hand and directions at the start are those of a command that states none.
        found = validate_files(result, measured, conventional_beside(result), "right", "1,1")
    report = file_validation_report(found, reader.name)
    worth = _worth(report, path_statement(found.validation), "validation")
    return replace(worth, origins=(*worth.origins, origin_of_run(reader)))


def _worth(report: Report, said: Statement, key: str) -> Worth:
    return Worth(said.sign, said.text, (report.section(key),), (), (report.origin,), said.short)
