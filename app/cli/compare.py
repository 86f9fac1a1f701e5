"""compare: two results of one arm."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, ResultFile
from catseye.app.cli.output import emit, emit_json, say


def compare(
    first: ResultFile,
    second: Annotated[Path, typer.Argument(metavar="RESULT", help="another one of the same arm")],
    as_json: AsJson = False,
) -> None:
    """Compare two results of one arm: links, error maps and reflectors, in combined standard uncertainties.

    Example: catseye compare january.json june.json
    """
    from catseye.app.analysis.result_comparison import compare_results, verdict
    from catseye.app.cli.compare_text import comparison_facts, comparison_table
    from catseye.app.files.result_json import read_result

    found = compare_results(read_result(first), read_result(second))
    if as_json:
        emit_json({"first": str(first), "second": str(second), **comparison_facts(found)})
    else:
        emit(comparison_table(found))
    for text in found.remarks:
        say(f"note: {text}")
    say(verdict(found))
