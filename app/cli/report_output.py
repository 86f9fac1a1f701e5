"""A report on the terminal: its tables are data, its statements are talk."""

from pathlib import Path

from catseye.app.cli.output import note, warn, write_line
from catseye.app.render.text import statement_line, tables_text
from catseye.app.results.model import Report, Sign, Statement


def require_page(output: Path | None, *sources: Path | None) -> None:
    """Refuse a page that could not be written, or that would replace a file that is read.

    Args:
        output: page to write; None for none.

    Raises:
        UsageError: the page cannot be written there.
    """
    from catseye.app.files.atomic import require_output
    from catseye.app.render.page import require_html

    require_output(output, *sources)
    if output is not None:
        require_html(output)


def hand_out_page(report: Report, output: Path | None) -> None:
    """Write a report as a page, where one was asked for."""
    from catseye.app.render.page import write_page

    if output is not None:
        write_page(report, output)
        note(f"{output} written")


def write_tables(report: Report) -> None:
    """Write the tables of a report to stdout."""
    write_line(tables_text(report))


def note_statements(report: Report) -> None:
    """Write the statements of a report to stderr."""
    for block in report.blocks(brief=True):
        if isinstance(block, Statement):
            note_statement(block)


def note_statement(statement: Statement) -> None:
    """Write a statement to stderr; one that needs attention as a warning."""
    if statement.sign is Sign.ATTENTION:
        warn(statement.text)
    else:
        note(statement_line(statement))
