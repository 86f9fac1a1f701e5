"""validate, of a SCARA: a model against an independent measurement."""

from pathlib import Path

from catseye.app.cli.output import note, write_json
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.cli.scara.options import HandName
from catseye.app.errors import MeasurementRejectedError
from catseye.app.files.atomic import require_output


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
    from catseye.app.render.page import require_html, write_page
    from catseye.app.results.scara.validation_document import validation_document
    from catseye.app.results.scara.validation_of_files import file_validation_report, validate_files

    require_output(output, result, measured, reference)
    if output is not None:
        require_html(output)
    found = validate_files(result, measured, reference, hand, start_direction)
    report = file_validation_report(found, measured.name)
    if as_json:
        write_json(validation_document(found, limit, report.figures("validation")).json_object())
    else:
        write_tables(report)
    note_statements(report)
    if output is not None:
        write_page(report, output)
        note(f"{output} written")
    left_um = found.validation.models[-1].comparison.rms_2d_um
    if limit is not None and left_um > limit:
        raise MeasurementRejectedError(
            f"{measured}: the model leaves {left_um:.1f} µm (2-D rms), more than the limit of {limit:g} µm"
        )
