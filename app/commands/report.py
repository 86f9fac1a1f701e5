"""report: one self-contained page about a run or a result."""

from pathlib import Path

from catseye.app.commands.output import say
from catseye.app.errors import UsageError
from catseye.app.render.page import require_html, write_page
from catseye.app.results.scara.run_content import result_content, run_content
from catseye.app.results.scara.run_report import run_report
from catseye.app.runs_folder import runs_folder
from catseye.app.store.catalog import resolve_run
from catseye.app.store.reader import RunReader, accept
from catseye.app.store.unverified import taken_as_it_is


def report_command(source: str, output: Path, runs: Path | None, unverified: bool = False) -> None:
    """Write the page."""
    require_html(output)
    direct = Path(source)
    if direct.is_file():
        write_page(run_report(result_content(direct)), output)
    elif direct.suffix.lower() == ".json":
        raise UsageError(f"{direct}: there is no such file")
    else:
        root = runs_folder(runs)
        path = resolve_run(root, source)
        reader = RunReader(path, accept(unverified=unverified))
        with taken_as_it_is(reader):
            content = run_content(reader, path.parent)
        write_page(run_report(content), output)
    say(f"{output} written")
