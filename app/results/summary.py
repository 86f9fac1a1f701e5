"""Tables of single figures, one a row."""

from collections.abc import Sequence
from dataclasses import dataclass

from catseye.app.results.model import Column, Quantity, Table
from catseye.app.results.numbers import COUNT, Format


@dataclass(frozen=True)
class Line:
    """One figure with its name and unit; `standard` as that of a Quantity."""

    name: str
    unit: str
    value: float | str
    format: Format = COUNT
    standard: bool = False


def summary_table(title: str, lines: Sequence[Line]) -> Table:
    """Return a table of figures; the title heads their names."""
    return Table(
        "summary",
        title,
        (Column("name", title), Column("unit", "unit"), Column("value", "value", format=COUNT)),
        tuple(
            (
                line.name,
                line.unit,
                line.value
                if isinstance(line.value, str)
                else Quantity(line.value, line.format, line.standard),
            )
            for line in lines
        ),
    )
