"""schema: the shape of what commands write for programs."""

import json
from typing import Annotated

import typer

from catseye.app.cli import completion
from catseye.app.cli.output import note, write_line
from catseye.app.cli.outputs import OUTPUTS, format_of, schema_of
from catseye.app.errors import UsageError


def schema(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]",
            help="name of the schema, or the format that stands in the output [lists all]",
            autocompletion=completion.documents,
        ),
    ] = None,
) -> None:
    """Print the JSON schema of a command's output. Without a name, list the names.

    Example: catseye schema events
    """
    if name is None:
        for each, output in OUTPUTS.items():
            write_line(f"{each:<20} {format_of(each):<31} {', '.join(output.commands)}: {output.summary}")
        note("catseye schema NAME prints the JSON schema of one")
        return
    write_line(json.dumps(schema_of(_known(name)), indent=2, ensure_ascii=False))


def _known(name: str) -> str:
    for each in OUTPUTS:
        if name in {each, format_of(each)}:
            return each
    raise UsageError(f"there is no document {name}: catseye schema lists the names")
