"""report: one self-contained page about a run or a result."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from catseye.app.cli.options import Runs, RunsOrResults, Unverified
from catseye.app.cli.output import note
from catseye.app.errors import UsageError
from catseye.app.files.atomic import require_output
from catseye.app.store.runs_folder import runs_folder

if TYPE_CHECKING:
    from catseye.app.results.model import Report


def report(
    source: RunsOrResults,
    output: Annotated[Path, typer.Option("-o", "--output", help="HTML file to write")],
    runs: Runs = None,
    unverified: Unverified = False,
) -> None:
    """Write an HTML report of a run or a result. For motion resolution it may combine several results.

    Example: catseye report result.json -o report.html
    """
    from catseye.app.render.page import require_html, write_page

    direct = [Path(name) for name in source]
    require_output(output, *direct)
    require_html(output)
    if any(path.is_file() for path in direct):
        page = _report_of_files(direct)
    elif len(source) > 1:
        raise UsageError("a report is of one run, or of result files: name one run")
    elif direct[0].suffix.lower() == ".json":
        raise UsageError(f"{direct[0]}: there is no such file")
    else:
        page = _report_of_run(source[0], runs, unverified=unverified)
    write_page(page, output)
    note(f"{output} written")


def _report_of_files(paths: list[Path]) -> "Report":
    """Return the report of result files, whose kind decides."""
    from catseye.app.results.resolution.report_files import is_of_resolution
    from catseye.app.results.resolution.result_report import resolution_files_report
    from catseye.app.results.scara.run_report import result_file_report
    from catseye.app.results.serial_arm.calibration_report import calibration_file_report
    from catseye.app.results.serial_arm.result import is_of_serial_arm

    if all(is_of_resolution(path) for path in paths):
        return resolution_files_report(paths)
    if len(paths) > 1:
        other = next(path for path in paths if not is_of_resolution(path))
        raise UsageError(
            f"{other}: is of another kind, or damaged; a report of several files takes those of motion "
            "resolution only, results, predictions (.json) and look-up tables (.csv): name one result"
        )
    if is_of_serial_arm(paths[0]):
        return calibration_file_report(paths[0])
    return result_file_report(paths[0])


def _report_of_run(name: str, runs: Path | None, *, unverified: bool) -> "Report":
    from catseye.app.results.resolution.recorded_runs import holds_tests
    from catseye.app.results.resolution.result_report import resolution_run_report
    from catseye.app.results.scara.run_report import run_report
    from catseye.app.results.serial_arm.run_report import is_on_serial_arm, serial_run_report
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader, accept
    from catseye.app.store.unverified import taken_as_it_is

    path = resolve_run(runs_folder(runs), name)
    reader = RunReader(path, accept(unverified=unverified))
    with taken_as_it_is(reader):
        if holds_tests(reader):
            return resolution_run_report(reader)
        if is_on_serial_arm(reader):
            return serial_run_report(reader)
        return run_report(reader, path.parent)
