"""Cells of a table as text, for every renderer."""

from catseye.app.results.model import Cell, Column, Quantity
from catseye.app.results.numbers import EXPANDED, MINUS, NOTHING, TEXT, number


def cell_text(cell: Cell, column: Column, minus: str = MINUS) -> str:
    """Return a cell as a reader sees it: standard uncertainties expanded (k = 2)."""
    if isinstance(cell, str):
        return cell
    if isinstance(cell, Quantity):
        value, form, standard = cell.value, cell.format, column.standard or cell.standard
    else:
        value, form, standard = cell, column.format, column.standard
    if value is None:
        return NOTHING
    return number(EXPANDED * value if standard else value, form, minus)


def is_numeric(column: Column) -> bool:
    """Return whether a column stands flush right."""
    return column.format is not TEXT
