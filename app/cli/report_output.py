"""A report on the terminal: its tables are data, its statements are talk."""

from catseye.app.cli.output import note, warn, write_line
from catseye.app.render.text import statement_line, tables_text
from catseye.app.results.model import Report, Sign, Statement


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
