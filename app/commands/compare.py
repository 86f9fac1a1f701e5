"""compare: two results of one arm."""

from pathlib import Path

from catseye.app.commands.output import emit, emit_json, say
from catseye.app.files.result_json import read_result
from catseye.app.render.text import statement_lines, tables_text
from catseye.app.results.origin import origin_now
from catseye.app.results.scara.comparison import compare_results
from catseye.app.results.scara.comparison_document import comparison_document
from catseye.app.results.scara.comparison_report import comparison_report


def compare_command(first: Path, second: Path, as_json: bool) -> None:
    """Compare, and write what was found.

    Raises:
        UsageError: a file is no result, or both have nothing in common.
    """
    found = compare_results(read_result(first), read_result(second))
    report = comparison_report(found, (first.name, second.name), origin_now())
    if as_json:
        emit_json({"first": str(first), "second": str(second), **comparison_document(found)})
    else:
        emit(tables_text(report))
    for line in statement_lines(report):
        say(line)
