"""trend: the results of one arm over months."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, CellFile, Runs
from catseye.app.cli.output import write_document
from catseye.app.cli.report_output import hand_out_page, note_statements, require_page, write_tables
from catseye.app.store.runs_folder import runs_folder


def trend(
    cell: CellFile,
    results: Annotated[
        list[Path] | None, typer.Argument(metavar="[RESULT]...", help="further results of this arm")
    ] = None,
    baseline: Annotated[
        Path | None, typer.Option(help="result to compare the others with [the oldest]")
    ] = None,
    output: Annotated[Path | None, typer.Option("-o", "--output", help="HTML file to write")] = None,
    runs: Runs = None,
    as_json: AsJson = False,
) -> None:
    """Compare all results of an arm with a baseline.

    The command finds the results of the cell's runs beside the cell file, and in and beside the folder of runs.

    Example: catseye trend cell.toml --baseline january.json -o trend.html
    """
    from catseye.app.cell.load import load_cell
    from catseye.app.results.trend.document import trend_document
    from catseye.app.results.trend.found import given_results, results_of_cell, trend_of
    from catseye.app.results.trend.report import trend_report

    require_page(output, cell, baseline, *(results or ()))
    name, root = load_cell(cell).cell.name, runs_folder(runs)
    found, remarks = results_of_cell(name, root, (cell.parent, root.absolute().parent, root))
    known = {result.path.absolute() for result in found}
    given = [*(results or ()), *([] if baseline is None or not baseline.is_file() else [baseline])]
    found += given_results(dict.fromkeys(path for path in given if path.absolute() not in known))
    told = trend_of(name, found, baseline, remarks)
    report = trend_report(told)
    hand_out_page(report, output)
    if as_json:
        write_document("trend", trend_document(told).json_object())
    else:
        write_tables(report)
    note_statements(report)
