"""A report on a terminal: statements with their sign, plain tables."""

from collections.abc import Iterator

from catseye.app.render.cells import cell_text, is_numeric
from catseye.app.render.signs import SIGNS
from catseye.app.results.model import Report, Statement, Table


def statement_line(statement: Statement) -> str:
    """Return a statement as one line."""
    return f"{SIGNS[statement.sign].prefix}{statement.text}"


def table_text(table: Table) -> str:
    """Return a plain table whose numbers a program can read."""
    head = [f"{column.title} {column.unit}".strip() for column in table.columns]
    body = [
        [cell_text(cell, column, minus="-") for cell, column in zip(row, table.columns, strict=True)]
        for row in table.rows
    ]
    widths = [max(map(len, cells)) for cells in zip(head, *body, strict=True)]
    right = [is_numeric(column) for column in table.columns]

    def line(cells: list[str]) -> str:
        parts = (
            cell.rjust(width) if flush else cell.ljust(width)
            for cell, width, flush in zip(cells, widths, right, strict=True)
        )
        return "  ".join(parts).rstrip()

    return "\n".join([line(head), line(["-" * width for width in widths]), *map(line, body)])


def tables_text(report: Report) -> str:
    """Return the tables that the command line writes to stdout; several of them have their captions."""
    tables = [block for block in report.blocks(brief=True) if isinstance(block, Table)]
    if len(tables) == 1:
        return table_text(tables[0])
    return "\n\n".join(f"{table.caption}\n{table_text(table)}" for table in tables)


def statement_lines(report: Report) -> Iterator[str]:
    """Yield the sentences that the command line writes beside them."""
    return (statement_line(block) for block in report.blocks(brief=True) if isinstance(block, Statement))
