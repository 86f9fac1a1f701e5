"""show: a run's story."""

from catseye.app.cli.options import AsJson, Runs, StoredRun, Unverified
from catseye.app.cli.output import write_json, write_line


def show(
    run: StoredRun,
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Tell a run's story: what, with which devices, what happened, how it ended."""
    from catseye.app.cli.show_text import run_facts, run_lines
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader, accept
    from catseye.app.store.runs_folder import runs_folder
    from catseye.app.store.unverified import taken_as_it_is

    reader = RunReader(resolve_run(runs_folder(runs), run), accept(unverified=unverified))
    with taken_as_it_is(reader):
        if as_json:
            write_json(run_facts(reader))
            return
        for line in run_lines(reader):
            write_line(line)
