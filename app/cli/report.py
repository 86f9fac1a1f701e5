"""report: one self-contained page about a run or a result."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import RunOrResult, Runs, Unverified
from catseye.app.cli.output import note
from catseye.app.errors import UsageError
from catseye.app.files.atomic import require_output
from catseye.app.store.runs_folder import runs_folder


def report(
    source: RunOrResult,
    output: Annotated[Path, typer.Option("-o", "--output", help="HTML file to write")],
    runs: Runs = None,
    unverified: Unverified = False,
) -> None:
    """Write one self-contained HTML page about a run or a result.

    Example: catseye report result.json -o report.html
    """
    from catseye.app.render.page import require_html, write_page
    from catseye.app.results.scara.run_report import result_file_report, run_report
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader, accept
    from catseye.app.store.unverified import taken_as_it_is

    direct = Path(source)
    require_output(output, direct)
    require_html(output)
    if direct.is_file():
        page = result_file_report(direct)
    elif direct.suffix.lower() == ".json":
        raise UsageError(f"{direct}: there is no such file")
    else:
        path = resolve_run(runs_folder(runs), source)
        reader = RunReader(path, accept(unverified=unverified))
        with taken_as_it_is(reader):
            page = run_report(reader, path.parent)
    write_page(page, output)
    note(f"{output} written")
