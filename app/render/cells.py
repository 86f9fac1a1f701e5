"""Cells of a table as text, for every renderer."""

from catseye.app.results.model import Cell, Column, Quantity
from catseye.app.results.numbers import MINUS, NOTHING, TEXT, number


def cell_text(cell: Cell, column: Column, minus: str = MINUS) -> str:
    """Return a cell as a reader sees it."""
    if isinstance(cell, Quantity):
        return number(cell.value, cell.format, minus)
    if isinstance(cell, str):
        return cell
    if cell is None:
        return NOTHING
    return number(cell, column.format, minus)


def is_numeric(column: Column) -> bool:
    """Return whether a column stands flush right."""
    return column.format is not TEXT
