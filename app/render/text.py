"""A report on a terminal: statements with their sign, plain tables."""

import textwrap
from collections.abc import Iterator
from typing import Final

from catseye.app.render.cells import cell_text, is_numeric
from catseye.app.render.signs import SIGNS
from catseye.app.results.model import Block, Bullets, Entries, Report, Section, Statement, Table

_WIDTH: Final = 118
_MARGIN: Final = "  "


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


def report_text(report: Report) -> str:
    """Return title, banners and all brief sections in reading order."""
    head = [report.title, *(f"{_MARGIN}{banner}" for banner in report.origin.banners)]
    sections = (_section_text(section) for section in report.sections if section.brief and section.blocks)
    return "\n\n".join(["\n".join(head), *sections])


def _section_text(section: Section) -> str:
    lines = (line for block in section.blocks for line in block_lines(block))
    return "\n".join([section.title, *(f"{_MARGIN}{line}" for line in lines)])


def block_lines(block: Block) -> list[str]:
    """Return a block as lines; none for what only a page shows."""
    match block:
        case Statement():
            return [f"{SIGNS[block.sign].glyph} {block.text}"]
        case Table():
            return table_text(block).splitlines()
        case Bullets():
            return [*([block.title] if block.title else []), *(f"- {text}" for text in block.texts)]
        case Entries():
            return _entry_lines(block)
        case _:
            return []


def _entry_lines(block: Entries) -> list[str]:
    """Return labels at the left and their texts, wrapped, at the right."""
    width = max((len(label) for label, _ in block.entries), default=0) + 2
    lines: list[str] = []
    for label, text in block.entries:
        first, *others = (part for line in text.splitlines() or [""] for part in _wrapped(line, width))
        lines += [f"{label:<{width}}{first}", *(f"{'':<{width}}{other}" for other in others)]
    return lines


def _wrapped(text: str, margin: int) -> list[str]:
    room = max(40, _WIDTH - len(_MARGIN) - margin)
    return textwrap.wrap(text, room, break_long_words=False, break_on_hyphens=False) or [""]


def tables_text(report: Report) -> str:
    """Return the tables that the command line writes to stdout; several of them have their captions."""
    tables = [block for block in report.blocks(brief=True) if isinstance(block, Table)]
    if len(tables) == 1:
        return table_text(tables[0])
    return "\n\n".join(f"{table.caption}\n{table_text(table)}" for table in tables)


def statement_lines(report: Report) -> Iterator[str]:
    """Yield the sentences that the command line writes beside them."""
    return (statement_line(block) for block in report.blocks(brief=True) if isinstance(block, Statement))
