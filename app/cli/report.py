"""report: one self-contained page about a run or a result."""

from pathlib import Path

from catseye.app.analysis.reporting import require_html, result_report, run_report
from catseye.app.cli.output import say
from catseye.app.errors import UsageError
from catseye.app.runs_folder import runs_folder
from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader, accept
from catseye.app.store.unverified import taken_as_it_is


def report_command(source: str, output: Path, runs: Path | None, unverified: bool = False) -> None:
    """Write the page."""
    require_html(output)
    direct = Path(source)
    if direct.is_file():
        result_report(direct, output)
    elif direct.suffix.lower() == ".json":
        raise UsageError(f"{direct}: there is no such file")
    else:
        root = runs_folder(runs)
        path = resolve_run(root, source)
        reader = RunReader(path, accept(unverified=unverified))
        with taken_as_it_is(reader):
            run_report(reader, path.parent, output)
    say(f"{output} written")
