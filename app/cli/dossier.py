"""dossier: the day of a cell on one page, with a certificate in front."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, CellFile, Runs, Unverified
from catseye.app.cli.output import note, write_document
from catseye.app.cli.surveyed import surveyed
from catseye.app.files.atomic import require_output
from catseye.app.store.runs_folder import runs_folder


def dossier(
    cell: CellFile,
    output: Annotated[Path, typer.Option("-o", "--output", help="HTML file to write")],
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Write an HTML report of a cell's day. It begins with a one-page certificate; each stage follows.

    Example: catseye dossier cell.toml -o dossier.html
    """
    from catseye.app.cell.load import load_cell
    from catseye.app.render.page import require_html, write_page
    from catseye.app.results.dossier.day import day_of, judged_at
    from catseye.app.results.dossier.document import dossier_document
    from catseye.app.results.dossier.report import dossier_report
    from catseye.app.store.reader import accept

    require_output(output, cell)
    require_html(output)
    root = runs_folder(runs)
    now = judged_at(root, load_cell(cell).cell.name)
    day = day_of(surveyed(cell, root, now, remember=False), root, accept(unverified=unverified))
    write_page(dossier_report(day), output)
    if as_json:
        write_document("dossier", dossier_document(day, output).json_object())
    note(f"{output} written")
