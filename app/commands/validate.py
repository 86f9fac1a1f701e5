"""validate: a model against an independent measurement."""

from pathlib import Path

from catseye.app.commands.output import emit, emit_json, say
from catseye.app.errors import MeasurementRejectedError
from catseye.app.render.page import require_html, write_page
from catseye.app.render.text import statement_lines, tables_text
from catseye.app.results.scara.file_validation_report import file_validation_report
from catseye.app.results.scara.validation_document import validation_facts
from catseye.app.results.scara.validation_of_files import validate_files
from catseye.calibration.kinematics import Hand


def validate_command(
    result: Path,
    measured: Path,
    reference: Path | None,
    output: Path | None,
    limit_um: float | None,
    hand: Hand,
    start_direction: str,
    as_json: bool,
) -> None:
    """Compare, tell, and draw.

    Raises:
        UsageError: a file or an option is wrong.
        MeasurementRejectedError: the model leaves more than the limit.
    """
    if output is not None:
        require_html(output)
    found = validate_files(result, measured, reference, hand, start_direction)
    report = file_validation_report(found, measured.name)
    if as_json:
        emit_json(validation_facts(found, limit_um))
    else:
        emit(tables_text(report))
    for line in statement_lines(report):
        say(line)
    if output is not None:
        write_page(report, output)
        say(f"{output} written")
    left_um = found.validation.models[-1].comparison.rms_2d_um
    if limit_um is not None and left_um > limit_um:
        raise MeasurementRejectedError(
            f"{measured}: the model leaves {left_um:.1f} µm (2-D rms), more than the limit of {limit_um:g} µm"
        )
