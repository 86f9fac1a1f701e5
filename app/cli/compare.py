"""compare: two results of one arm."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, ResultFile
from catseye.app.cli.output import write_document
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.errors import MeasurementRejectedError
from catseye.app.results.origin import origin_now


def compare(
    first: ResultFile,
    second: Annotated[Path, typer.Argument(metavar="RESULT", help="another result of the same arm")],
    limit_u: Annotated[
        float | None,
        typer.Option(
            "--limit-u",
            metavar="K",
            min=0.0,
            help="largest difference allowed, in combined u; a larger one gives exit code 1",
        ),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Compare two results of one arm. Differences are also given in combined standard uncertainties.

    Example: catseye compare january.json june.json
    """
    from catseye.app.results.serial_arm.result import is_of_serial_arm

    if is_of_serial_arm(first):
        largest = _compare_arms(first, second, limit_u, as_json=as_json)
    else:
        largest = _compare_scaras(first, second, limit_u, as_json=as_json)
    if limit_u is not None and largest is None:
        raise MeasurementRejectedError(
            f"{second}: nothing of it can be judged against {first}: no uncertainty of a change is known"
        )
    if limit_u is not None and largest is not None and abs(largest[1]) > limit_u:
        name, size = largest
        raise MeasurementRejectedError(
            f"{second}: {name} has changed against {first} by {size:+.1f} standard uncertainties of the change, "
            f"which exceeds the limit of {limit_u:g}"
        )


def _compare_arms(
    first: Path, second: Path, limit_u: float | None, *, as_json: bool
) -> tuple[str, float] | None:
    """Compare calibrations of a serial arm; return what differs most, and by how many standard uncertainties."""
    from catseye.app.results.serial_arm.comparison import compare_arms, comparison_report
    from catseye.app.results.serial_arm.result import read_serial_arm

    found = compare_arms(read_serial_arm(first), read_serial_arm(second))
    report = comparison_report(found, (first.name, second.name))
    if as_json:
        write_document("arm-comparison", found.document(first, second, limit_u).json_object())
    else:
        write_tables(report)
    note_statements(report)
    return found.largest


def _compare_scaras(
    first: Path, second: Path, limit_u: float | None, *, as_json: bool
) -> tuple[str, float] | None:
    """Compare results of a SCARA; return what has changed most, and by how many standard uncertainties."""
    from catseye.app.results.scara.comparison import compare_results
    from catseye.app.results.scara.comparison_document import comparison_document
    from catseye.app.results.scara.comparison_report import comparison_report
    from catseye.app.results.scara.result import read_result

    found = compare_results(read_result(first), read_result(second))
    report = comparison_report(found, (first.name, second.name), origin_now())
    if as_json:
        write_document("comparison", comparison_document(found, first, second, limit_u).json_object())
    else:
        write_tables(report)
    note_statements(report)
    return found.largest
