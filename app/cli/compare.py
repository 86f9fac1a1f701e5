"""compare: two results of one arm."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, ResultFile
from catseye.app.cli.output import write_json
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.results.origin import origin_now


def compare(
    first: ResultFile,
    second: Annotated[Path, typer.Argument(metavar="RESULT", help="another one of the same arm")],
    as_json: AsJson = False,
) -> None:
    """Compare two results of one arm: links, error maps and reflectors, in combined standard uncertainties.

    Example: catseye compare january.json june.json
    """
    from catseye.app.results.scara.comparison import compare_results
    from catseye.app.results.scara.comparison_document import comparison_document
    from catseye.app.results.scara.comparison_report import comparison_report
    from catseye.app.results.scara.result import read_result

    found = compare_results(read_result(first), read_result(second))
    report = comparison_report(found, (first.name, second.name), origin_now())
    if as_json:
        write_json(comparison_document(found, first, second).json_object())
    else:
        write_tables(report)
    note_statements(report)
