"""config: checking and showing cell files."""

import difflib
import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from catseye.app.cli import completion
from catseye.app.cli.options import AsJson, CellFile
from catseye.app.cli.output import note, warn, write_document, write_line
from catseye.app.engine.instruments import require_drivers
from catseye.app.errors import ConfigError, UsageError
from catseye.app.files.atomic import require_output, write_atomically
from catseye.app.files.flat import flattened

if TYPE_CHECKING:
    from catseye.app.cell.model import Cell

config = typer.Typer(
    help="Check and show cell files.", no_args_is_help=True, add_completion=False, rich_markup_mode=None
)


@config.command()
def validate(file: CellFile, as_json: AsJson = False) -> None:
    """Check a cell file. Each fault is listed with file, line, key and the nearest valid key."""
    from catseye.app.cell.load import load_cell
    from catseye.app.cell.plausible import implausible
    from catseye.app.cli.documents import CellCheck

    try:
        loaded = load_cell(file)
        # Drivers, their settings and their profiles are known to the installation alone.
        require_drivers(loaded.cell)
    except ConfigError as error:
        if as_json:
            check = CellCheck(file=str(file), valid=False, faults=str(error).splitlines())
            write_document("cell-check", check.json_object())
        raise
    doubts = [*_no_door(loaded.cell), *implausible(loaded.cell)]
    if as_json:
        name, sha256 = loaded.cell.name, loaded.sha256
        check = CellCheck(file=str(file), valid=True, name=name, sha256=sha256, warnings=doubts)
        write_document("cell-check", check.json_object())
    else:
        note(f"{file}: cell {loaded.cell.name} is valid")
    for text in doubts:
        warn(text)


@config.command()
def show(file: CellFile, as_json: AsJson = False) -> None:
    """Show every value of a cell file. States whether it comes from the file or is a default."""
    from catseye.app.cell.load import load_cell
    from catseye.app.cli.documents import CellValues

    loaded = load_cell(file)
    configuration = loaded.cell.model_dump(mode="json")
    if as_json:
        shown = CellValues(
            file=str(file), sha256=loaded.sha256, configuration=configuration, origins=dict(loaded.origins)
        )
        write_document("cell-values", shown.json_object())
        return
    values = flattened(configuration)
    for key, origin in loaded.origins.items():
        write_line(f"{key} = {json.dumps(values.get(key), ensure_ascii=False)}  # {origin}")


@config.command()
def schema(
    file: Annotated[
        Path | None, typer.Argument(metavar="[FILE]", help="ignored: all cell files have one schema")
    ] = None,
) -> None:
    """Print the JSON schema of the cell file."""
    from catseye.app.cell.model import Cell

    if file is not None and not file.is_file():
        raise UsageError(f"{file}: there is no such file; the schema needs none: catseye config schema")
    write_line(json.dumps(Cell.model_json_schema(), indent=2, ensure_ascii=False))


@config.command()
def profile(
    name: Annotated[
        str | None,
        typer.Argument(
            metavar="[NAME]", help="name of the profile [lists all]", autocompletion=completion.profiles
        ),
    ] = None,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="TOML file to write, never overwritten [stdout]")
    ] = None,
) -> None:
    """Write out a driver's profile. Complete the copy with the instrument's manual.

    Example: catseye config profile distax -o mine.toml
    """
    from catseye.app.cell.profiles import profiles_by_driver

    brought = profiles_by_driver()
    if name is None:
        for known, (driver, _) in brought.items():
            write_line(f"{known:<{max(map(len, brought))}}  {driver}")
        return
    if name not in brought:
        close = difflib.get_close_matches(name, brought, n=1)
        meant = f"did you mean {close[0]}? " if close else ""
        raise UsageError(f"there is no profile {name!r}; {meant}Drivers bring along: {', '.join(brought)}")
    driver, text = brought[name]
    if output is None:
        write_line(text.rstrip("\n"))
        return
    require_output(output)
    if output.exists():
        raise UsageError(f"{output} exists already; choose another name or remove it")
    write_atomically(output, text)
    note(
        f'{output} written. Complete it; the cell file names it beside driver = "{driver}": profile = "{output}"'
    )


def _no_door(cell: "Cell") -> list[str]:
    """Return that no door is watched, unless the cell says that its robot is emulated."""
    from catseye.app.cell.hands import robot_is_emulated
    from catseye.app.engine.interlock import NO_DOOR

    return [] if robot_is_emulated(cell) or cell.io is not None else [NO_DOOR]
