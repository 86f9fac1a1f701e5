"""show: a run's timeline."""

from catseye.app.cli.options import AsJson, Runs, StoredRun, Unverified
from catseye.app.cli.output import write_document, write_line
from catseye.app.render.text import report_text
from catseye.app.store.runs_folder import runs_folder


def show(
    run: StoredRun,
    runs: Runs = None,
    unverified: Unverified = False,
    as_json: AsJson = False,
) -> None:
    """Show the history and the results of a run."""
    from catseye.app.results.found import found_sections
    from catseye.app.results.runs.documents import run_document
    from catseye.app.results.runs.reports import story_report
    from catseye.app.store.catalog import resolve_run
    from catseye.app.store.reader import RunReader, accept
    from catseye.app.store.unverified import taken_as_it_is

    reader = RunReader(resolve_run(runs_folder(runs), run), accept(unverified=unverified))
    with taken_as_it_is(reader):
        found = found_sections(reader)
        if as_json:
            write_document("run", run_document(reader, found).model_dump(mode="json"))
        else:
            write_line(report_text(story_report(reader, found)))
