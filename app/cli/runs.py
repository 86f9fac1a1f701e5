"""runs: the list of stored runs."""

from catseye.app.cli.options import AsJson, Runs
from catseye.app.cli.output import note, write_document
from catseye.app.cli.report_output import write_tables
from catseye.app.store.runs_folder import runs_folder


def runs(runs: Runs = None, as_json: AsJson = False) -> None:
    """List the stored runs, oldest first."""
    from catseye.app.results.runs.documents import run_entry
    from catseye.app.results.runs.reports import list_report
    from catseye.app.store.catalog import list_runs

    root = runs_folder(runs)
    entries = list(map(run_entry, list_runs(root)))
    if as_json:
        for entry in entries:
            write_document("run-entry", entry.model_dump(mode="json"))
    elif entries:
        write_tables(list_report(entries))
    else:
        note(f"no runs in {root}; start one with: catseye run PROCEDURE --cell FILE")
