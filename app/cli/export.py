"""export: a run's rows or a result's values for other programs."""

import json
from pathlib import Path
from typing import Literal

from catseye.app.analysis.exporting import Export, result_export, run_export
from catseye.app.cli.output import say
from catseye.app.errors import UsageError
from catseye.app.files.atomic import write_atomically
from catseye.app.files.csv_text import comment_lines
from catseye.app.files.tabular import table_parquet
from catseye.app.runs_folder import runs_folder
from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader, accept
from catseye.app.store.unverified import taken_as_it_is

Format = Literal["csv", "json", "parquet"]

_ENDINGS: dict[str, Format] = {".csv": "csv", ".json": "json", ".parquet": "parquet"}


def export_command(
    source: str, output: Path, form: Format | None, runs: Path | None, unverified: bool = False
) -> None:
    """Write the table."""
    chosen = form_of(output, form)
    direct = Path(source)
    if direct.is_file():
        if output.exists() and output.samefile(direct):
            raise UsageError(f"{output} is the result itself; choose another -o FILE")
        table = result_export(direct)
    elif direct.suffix.lower() == ".json":
        raise UsageError(f"{direct}: there is no such file")
    else:
        reader = RunReader(resolve_run(runs_folder(runs), source), accept(unverified=unverified))
        with taken_as_it_is(reader):
            table = run_export(reader)
    for text in table.unverified:
        say(f"UNVERIFIED: {text}")
    write_atomically(output, _written(table, chosen))
    say(f"{output}: {len(table.rows)} rows ({table.content}) of {table.source}")


def form_of(output: Path, form: Format | None) -> Format:
    """Return the format that is meant.

    Args:
        output: file to write; its ending may say the format.
        form: what was asked for; None leaves it to the ending.

    Raises:
        UsageError: the ending says nothing, or something else than what was asked for.
    """
    ending = _ENDINGS.get(output.suffix.lower())
    chosen = form or ending
    if chosen is None:
        raise UsageError(
            f"{output}: say what to write: --format csv, json or parquet, or a FILE that ends so"
        )
    if ending is not None and chosen != ending:
        raise UsageError(
            f"{output} would hold {chosen}, though its name says {ending}: "
            f"write -o {output.with_suffix(f'.{chosen}')} or --format {ending}"
        )
    return chosen


def _written(table: Export, form: Format) -> str | bytes:
    match form:
        case "csv":
            return comment_lines(f"UNVERIFIED: {text}" for text in table.unverified) + table.csv
        case "json":
            return json.dumps({**_about(table), table.content: table.rows}, ensure_ascii=False) + "\n"
        case _:
            return table_parquet(table.rows, {"unverified": table.unverified} if table.unverified else {})


def _about(table: Export) -> dict[str, object]:
    return {**table.about, "unverified": table.unverified} if table.unverified else dict(table.about)
