"""init: a cell file to begin with."""

from pathlib import Path
from typing import Annotated

import typer

from catseye.app.cell.templates import SCARA, TEMPLATES
from catseye.app.cli.output import note
from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically


def _arms(system: str) -> str:
    return f"{' or '.join(TEMPLATES[system].by_arm)} for {system}"


def init(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="cell file to write; never overwritten")],
    system: Annotated[
        str, typer.Option(metavar="NAME", help=f"what to measure: {' or '.join(TEMPLATES)}")
    ] = SCARA,
    arm: Annotated[
        str | None,
        typer.Option(metavar="NAME", help="arm of the bench: " + "; ".join(map(_arms, TEMPLATES))),
    ] = None,
) -> None:
    """Write a commented cell file. It is a template for error maps, motion resolution or a six-axis arm.

    Example: catseye init cell.toml
    """
    if system not in TEMPLATES:
        raise UsageError(f"there is no system {system!r}; there are {', '.join(TEMPLATES)}")
    texts = TEMPLATES[system].by_arm
    if arm is not None and arm not in texts:
        raise UsageError(
            f"there is no cell file of {arm} for {system}: choose --arm {' or '.join(texts)}, and write the "
            "name or the description of your arm into the file"
        )
    if file.exists():
        raise UsageError(f"{file} exists already; choose another name or remove it")
    if not file.parent.is_dir():
        raise UsageError(f"{file.parent} is not a folder; make it first")
    write_atomically(file, texts[arm] if arm else TEMPLATES[system].text)
    note(f"{file} written. Next: catseye emulate {file}, and in another terminal: catseye doctor {file}")
