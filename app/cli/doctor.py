"""doctor: who answers behind each endpoint, what is wrong and what to do."""

import asyncio
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, CellFile
from catseye.app.cli.output import warn, write_document, write_line
from catseye.app.errors import LinkFailedError
from catseye.app.render.text import report_text
from catseye.app.results.examination import examination_report


def doctor(
    file: CellFile,
    device: Annotated[
        str | None, typer.Option(help="check only this device, named as in the cell file")
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Check the devices of a cell file. Shows which answer, their status, what is wrong and how to fix it."""
    from catseye.app.cell.load import load_cell
    from catseye.app.cell.plausible import implausible
    from catseye.app.protocol.examination import CellExamination
    from catseye.app.service.examination import examine

    cell = load_cell(file).cell
    devices = asyncio.run(examine(cell, device))
    examination = CellExamination(cell=cell.name, devices=devices, warnings=implausible(cell))
    for text in examination.warnings:
        warn(text)
    if as_json:
        write_document("doctor", examination.model_dump(mode="json"))
    else:
        write_line(report_text(examination_report(examination)))
    bad = [examined.device for examined in devices if not examined.ok]
    if bad:
        raise LinkFailedError(f"cannot be used: {', '.join(bad)}; see the advice above")
