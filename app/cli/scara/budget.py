"""budget: what a run has measured of the error budget, into its cell file."""

import sys
from typing import Annotated

import typer

from catseye.app.cli.options import AsJson, CellOption, Runs, StoredRun, Unverified
from catseye.app.cli.output import write_document
from catseye.app.cli.report_output import note_statement, note_statements, write_tables
from catseye.app.errors import UsageError
from catseye.app.store.runs_folder import runs_folder


def budget(
    run: StoredRun,
    cell: CellOption,
    yes: Annotated[bool, typer.Option("--yes", help="write without asking")] = False,
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Write measured error motions into the cell file. They replace values of the error budget.

    Shows old and new values and asks before it writes; with --json it writes only if --yes is given. Each value is
    written with the name of the run that measured it.

    Example: catseye budget 1a2b3c --cell cell.toml
    """
    from catseye.app.cell.load import load_cell
    from catseye.app.results.scara.measured_budget import (
        budget_document,
        budget_report,
        measured_budget,
        write_budget,
    )
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader, accept

    reader = RunReader(resolve_run(runs_folder(runs), run), accept(unverified=unverified))
    found = measured_budget(reader, load_cell(cell))
    if not as_json:
        write_tables(budget_report(found, written=False))
    for each in found.reservations:
        note_statement(each)
    written = yes or (not as_json and _agreed(f"Write this into {cell}? [y/N] "))
    if written:
        write_budget(found)
    if as_json:
        write_document("measured-budget", budget_document(found, written=written).model_dump(mode="json"))
    note_statements(budget_report(found, written=written))


def _agreed(question: str) -> bool:
    """Ask whoever is there.

    Raises:
        UsageError: nobody is there.
    """
    if not sys.stdin.isatty():
        raise UsageError(
            "a question is asked before the cell file is changed, and nobody is there: add --yes"
        )
    return input(question).strip().lower() in {"y", "yes"}
