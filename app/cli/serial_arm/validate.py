"""validate, of a serial arm: a calibration against poses that it has not seen."""

from pathlib import Path
from typing import TYPE_CHECKING

from catseye.app.cli.output import write_document
from catseye.app.cli.report_output import hand_out_page, note_statements, require_page, write_tables
from catseye.app.cli.serial_arm.load import warn_of_load
from catseye.app.errors import MeasurementRejectedError

if TYPE_CHECKING:
    from catseye.app.cli.serial_arm.measured_runs import MeasuredRuns


def validate(
    result: Path,
    measured: Path,
    runs: "MeasuredRuns",
    anchors: Path | None,
    output: Path | None,
    limit_mm: float | None,
    *,
    as_json: bool = False,
) -> None:
    """Compare a calibration with measured poses.

    Args:
        measured: table of poses, or the run that is the first of `runs`.

    Raises:
        MeasurementRejectedError: more is left than the limit.
    """
    from catseye.app.results.serial_arm.result import read_serial_arm
    from catseye.app.results.serial_arm.run_poses import world_covariance
    from catseye.app.results.serial_arm.validation import validate_arm
    from catseye.app.results.serial_arm.validation_document import arm_validation_document
    from catseye.app.results.serial_arm.validation_report import arm_validation_report

    table = runs.tables[0] if runs.tables else measured
    require_page(output, result, table, anchors)
    identified = read_serial_arm(result)
    warn_of_load(identified)
    frame = world_covariance(runs.readers[0]) if runs.readers else None
    found = validate_arm(identified, table, anchors, frame)
    report = arm_validation_report(found, table.name, runs.origin_with(identified))
    hand_out_page(report, output)
    if as_json:
        write_document("arm-validation", arm_validation_document(found).json_object())
    else:
        write_tables(report)
    note_statements(report)
    mean_mm = found.calibrated.figures()["mean_mm"]
    if limit_mm is not None and mean_mm > limit_mm:
        raise MeasurementRejectedError(
            f"{table}: the calibrated arm leaves {mean_mm:.3f} mm on average, more than the limit of "
            f"{limit_mm:g} mm"
        )
