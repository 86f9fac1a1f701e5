"""doctor: who answers behind each endpoint, what is wrong and what to do."""

import asyncio
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated

import typer

from catseye.app.cli.options import AsJson, CellFile
from catseye.app.cli.output import warn, write_json, write_line

if TYPE_CHECKING:
    from catseye.app.service.examination import Finding


def doctor(
    file: CellFile,
    device: Annotated[str | None, typer.Option(help="only this device, by its name in the cell file")] = None,
    as_json: AsJson = False,
) -> None:
    """Connect to each device of a cell file: who answers, its status, what is wrong and what to do."""
    from catseye.app.cell.load import load_cell
    from catseye.app.cell.plausible import implausible
    from catseye.app.errors import LinkFailedError
    from catseye.app.service.examination import examine

    loaded = load_cell(file)
    findings = asyncio.run(examine(loaded.cell, device))
    doubts = implausible(loaded.cell)
    for text in doubts:
        warn(text)
    if as_json:
        devices = [asdict(finding) for finding in findings]
        write_json({"cell": loaded.cell.name, "devices": devices, "warnings": doubts})
    else:
        for finding in findings:
            write_line(_text(finding))
    bad = [finding.device for finding in findings if not finding.ok]
    if bad:
        raise LinkFailedError(f"cannot be used: {', '.join(bad)}; see the advice above")


def _text(finding: "Finding") -> str:
    mark = "ok  " if finding.ok else "BAD "
    emulated = "  [EMULATED]" if finding.simulated else ""
    lines = [f"{mark} {finding.device:<15} {finding.endpoint}  {finding.identity}{emulated}"]
    lines += [f"       {fact}" for fact in finding.status]
    lines += [f"       do: {text}" for text in finding.advice]
    return "\n".join(lines)
