"""Tables that come from outside, as columns: whoever owns a table declares what its files may hold."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal, Protocol, Self

import numpy as np
from numpy.typing import NDArray

Kind = Literal["number", "integer", "direction", "name"]

_WANTED: dict[Kind, str] = {
    "number": "a finite number",
    "integer": "an integer up to 2^53",
    "direction": "1 or -1",
    "name": "a known name",
}


@dataclass(frozen=True)
class ColumnRule:
    """What a column may hold.

    Attributes:
        name: as in the header, with its unit.
        kind: a number is finite, an integer within ±2^53, a direction 1 or -1, a name one of those that the reader
            is given.
        unit: of the numbers, for complaints.
        optional: the whole column may be missing.
        positive: numbers are above 0.
        largest: largest number, of either sign; None for no limit.
        hint: what a larger number points to and what to do about it.
        empty: complaint about an empty cell; "" for the usual one.
        needed: why the column is needed, for the complaint about a file without it.
        known_to: what knows the names, for the complaint about another one.
    """

    name: str
    kind: Kind = "number"
    unit: str = ""
    optional: bool = False
    positive: bool = False
    largest: float | None = None
    hint: str = ""
    empty: str = ""
    needed: str = ""
    known_to: str = ""

    @property
    def wanted(self) -> str:
        """What a value has to be, in words."""
        return _WANTED[self.kind] + (" above 0" if self.positive else "")


@dataclass(frozen=True)
class TableRule:
    """What the header of a table may hold.

    Attributes:
        holds: what the file is a list of, in the plural: points.
        row: what a row is: one distance.
        forms: columns in the order in which they are written; where there are several forms, a file has one of them,
            the last one unless columns of another are in its header.
        mixed: complaint about columns of two forms in one file.
        misplaced: complaints by the name of a column that belongs to another kind of file.
        source: where such files come from, for the complaint about a missing column; such a file may have further
            columns, which are passed over.
        drawing: model of a TOML file that stands for rows; None where there is no such file.
        named: rows are of poses, by their names in a column `pose`; a pose may have several, one a target that a
            column `target` may name.
    """

    holds: str
    row: str
    forms: tuple[tuple[ColumnRule, ...], ...]
    mixed: str = ""
    misplaced: tuple[tuple[str, str], ...] = ()
    source: str = ""
    drawing: type["Drawing"] | None = None
    named: bool = False


@dataclass(frozen=True)
class DocumentRule:
    """A document that a parameter takes from a file, JSON or TOML by the end of its name.

    Attributes:
        holds: what it is: a calibration of a serial arm.
        format: that stands in it under this name.
    """

    holds: str
    format: str


@dataclass(frozen=True)
class Columns:
    """Rows of a table, column by column.

    Attributes:
        values: by name of the column, in the file's units, shape (n,) each; names are places in `names`, -1 for an
            unknown one.
        lines: where each row stands: line of a CSV file, row of any other, from 1, shape (n,).
        names: what the places of a column of names stand for.
        attached: documents that stand with the table, JSON by their kind (`catseye.app.files.attached`).
        counted: what `lines` counts: lines of a file, or the segments of a drawing.
    """

    values: Mapping[str, NDArray[np.float64]]
    lines: NDArray[np.int64]
    names: tuple[str, ...] = ()
    attached: Mapping[str, str] = field(default_factory=dict)
    counted: Literal["line", "segment"] = "line"

    def __len__(self) -> int:
        """Return the number of rows."""
        return self.lines.size

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Return a column, shape (n,)."""
        return self.values[name]

    def get(self, name: str) -> NDArray[np.float64] | None:
        """Return a column, shape (n,); None if the file does not have it."""
        return self.values.get(name)

    def __contains__(self, name: str) -> bool:
        """Return whether the file has a column."""
        return name in self.values

    def first(self, rows: int) -> "Columns":
        """Return the first rows alone."""
        values = {name: column[:rows] for name, column in self.values.items()}
        return replace(self, values=values, lines=self.lines[:rows])

    def stacked(self, names: Sequence[str]) -> NDArray[np.float64]:
        """Return columns side by side, shape (n, number of names)."""
        return np.column_stack([self.values[name] for name in names])


class Drawing(Protocol):
    """A document in TOML that stands for the rows of a table."""

    @classmethod
    def model_validate(cls, obj: Any) -> Self:
        """Return a checked document; raises what pydantic raises."""
        ...

    def columns(self) -> Columns:
        """Return its rows."""
        ...
