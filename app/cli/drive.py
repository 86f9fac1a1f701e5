"""How a plan is driven from the command line, whether it is new or goes on."""

import asyncio
import sys
from contextlib import suppress
from pathlib import Path

from catseye.app.cli.failure import failure_as_json
from catseye.app.cli.going_on import say_how_to_go_on
from catseye.app.cli.hosting import DriveOptions, serve_and_run
from catseye.app.cli.outlet import patient_output
from catseye.app.cli.output import note, write_document, write_line
from catseye.app.cli.report_output import note_statements, write_tables
from catseye.app.engine.heap import settled_heap
from catseye.app.errors import OutputError
from catseye.app.exitcode import ExitCode
from catseye.app.results.rehearsal import rehearsal_report
from catseye.app.service.rehearsal import rehearsal_of
from catseye.app.service.running import PlannedRun, rehearse


def conduct(planned: PlannedRun, root: Path, options: DriveOptions, *, dry_run: bool) -> None:
    """Rehearse a plan, or run it and end the process with the run's exit code."""
    if dry_run:
        _rehearse(planned, as_json=options.as_json)
        note("a real arm needs a walk-through of this first (--walk), or a reason (--waive-walk)")
        return
    with patient_output():
        with settled_heap(), failure_as_json(as_json=options.as_json, stream=True):
            outcome = asyncio.run(serve_and_run(planned, root, options))
        if outcome.exit_code != ExitCode.DONE:
            say_how_to_go_on(outcome.path)
        if not options.as_json:
            _write_path(outcome.path)
    sys.exit(int(outcome.exit_code))


def _write_path(path: Path) -> None:
    # How the run ended is told by its exit code, whoever reads where it is.
    with suppress(OutputError):
        write_line(str(path))


def _rehearse(planned: PlannedRun, *, as_json: bool) -> None:
    rehearsal = rehearsal_of(planned, asyncio.run(rehearse(planned)))
    report = rehearsal_report(rehearsal)
    if as_json:
        write_document("rehearsal", rehearsal.model_dump(mode="json"))
    else:
        write_tables(report)
    note_statements(report)
