"""validate, of a SCARA: a model against an independent measurement."""

from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.cli.output import note, warn, write_json
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cli.scara.options import HandName
from catseye.app.errors import MeasurementRejectedError, UsageError
from catseye.app.files.atomic import require_output
from catseye.app.store.runs_folder import runs_folder

if TYPE_CHECKING:
    from catseye.app.results.model import Report
    from catseye.app.store.reader import RunReader


def validate(
    result: Path,
    measured: Path,
    reference: Path | None = None,
    output: Path | None = None,
    limit: float | None = None,
    hand: HandName = "right",
    start_direction: str = "1,1",
    as_json: bool = False,
) -> None:
    """Compare a model with an independent measurement.

    Raises:
        MeasurementRejectedError: more is left than the limit.
    """
    from catseye.app.results.scara.validation_document import validation_document
    from catseye.app.results.scara.validation_of_files import file_validation_report, validate_files

    _require_page(output, result, measured, reference)
    found = validate_files(result, measured, reference, hand, start_direction)
    report = file_validation_report(found, measured.name)
    _write(report, output)
    if as_json:
        write_json(validation_document(found, limit, report.figures("validation")).json_object())
    else:
        write_tables(report)
    note_statements(report)
    _require_within(limit, found.validation.models[-1].comparison.rms_2d_um, f"{measured}", "2-D rms")


def validate_run(
    result: Path,
    run: str,
    runs: Path | None,
    reference: Path | None = None,
    output: Path | None = None,
    limit: float | None = None,
    as_json: bool = False,
) -> None:
    """Compare a model with the path that a run has measured, by positions or by distances.

    Args:
        reference: model to compare with; None for the conventional one of the same runs that lies beside the result.

    Raises:
        MeasurementRejectedError: more is left than the limit.
        UsageError: the run has measured no path, or its models cannot be those of the result.
    """
    from catseye.app.results.scara.path_as_file import path_as_file
    from catseye.app.results.scara.validation_of_run import conventional_beside, has_distances
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader

    reader = RunReader(resolve_run(runs_folder(runs), run))
    if has_distances(reader):
        _validate_distances(result, reader, reference, output, limit, as_json=as_json)
        return
    if reference is None and (reference := conventional_beside(result)) is not None:
        note(f"compared with {reference}, the conventional model of the same runs")
    with path_as_file(reader) as measured:
        validate(result, measured, reference, output, limit, as_json=as_json)


def _validate_distances(
    result: Path,
    reader: "RunReader",
    reference: Path | None,
    output: Path | None,
    limit: float | None,
    *,
    as_json: bool,
) -> None:
    from catseye.app.results.scara.validation_of_run import (
        distance_document,
        distance_report,
        is_conventional_of,
        validate_run,
    )

    _require_page(output, result, reference)
    if reference is not None and not is_conventional_of(reference, result):
        raise UsageError(
            f"{reader.name} has measured distances, which are compared with both models of the result's runs: "
            f"{reference} is no conventional model of them; leave --reference away"
        )
    found = validate_run(result, reader)
    for text in found.notes:
        warn(text)
    if found.distances is None:
        raise TypeError("a run of distances is compared by distances")
    report = distance_report(found, reader)
    _write(report, output)
    if as_json:
        write_json(distance_document(found.distances, limit).json_object())
    else:
        write_tables(report)
    note_statements(report)
    _require_within(limit, found.distances.models[-1].rms_um, reader.name, "rms of distances")


def _require_page(output: Path | None, *sources: Path | None) -> None:
    from catseye.app.render.page import require_html

    require_output(output, *sources)
    if output is not None:
        require_html(output)


def _write(report: "Report", output: Path | None) -> None:
    from catseye.app.render.page import write_page

    if output is not None:
        write_page(report, output)
        note(f"{output} written")


def _require_within(limit: float | None, left_um: float, measured: str, what: str) -> None:
    if limit is not None and left_um > limit:
        raise MeasurementRejectedError(
            f"{measured}: the model leaves {left_um:.1f} µm ({what}), more than the limit of {limit:g} µm"
        )
