"""What a procedure keeps: a record type is a frozen dataclass, and its fields are the columns of a table."""

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache
from types import NoneType, UnionType
from typing import Any, ClassVar, Final, Literal, get_args, get_origin, get_type_hints

Json = None | bool | int | float | str | list["Json"] | dict[str, "Json"]
"""Anything that JSON can carry."""

Row = Mapping[str, Json]
"""One record: names with units, plain values."""

ColumnKind = Literal["REAL", "INTEGER", "TEXT"]
"""A type of SQLite's."""

_KINDS: Final[Mapping[type, ColumnKind]] = {float: "REAL", int: "INTEGER", str: "TEXT"}
_NAME: Final = re.compile(r"[a-z][a-z0-9_]{0,62}")
KEY: Final = ("step_id", "attempt", "seq")
"""Columns before those of a record: step, attempt at it, number within the step."""

EXTRA: Final = "extra"
"""The column behind them: further values as JSON."""

_RESERVED: Final = frozenset({"meta", "steps", "events", "prompts", "journal", "chunks"})

_TAKEN: Final = frozenset({*KEY, EXTRA, "place", "rowid", "oid"})
"""Columns that the store has itself, or that SQLite and a reader number rows by."""


@dataclass(frozen=True)
class Column:
    """A column of a table.

    Attributes:
        name: with its unit.
        kind: type of its values.
        required: every row has it.
    """

    name: str
    kind: ColumnKind
    required: bool


@dataclass(frozen=True)
class Table:
    """A table of a run. Its columns stand between the key and `extra`.

    Attributes:
        name: as commands and exports call it.
        columns: in order.

    Raises:
        ValueError: a name is the store's or SQLite's own, or no plain word.
    """

    name: str
    columns: tuple[Column, ...]

    def __post_init__(self) -> None:
        """Check the names."""
        names = [column.name for column in self.columns]
        wrong = [name for name in (self.name, *names) if not _NAME.fullmatch(name)]
        taken = {self.name} & _RESERVED | set(names) & _TAKEN
        if wrong or taken or self.name.startswith("sqlite_") or len(set(names)) < len(names):
            raise ValueError(f"table {self.name!r} with columns {', '.join(names)}: choose other names")

    @property
    def required(self) -> tuple[str, ...]:
        """Names of the columns that every row has."""
        return tuple(column.name for column in self.columns if column.required)


@dataclass(frozen=True, kw_only=True)
class Record:
    """Base of record types. A field of type float, int or str is a column; `| None` makes it optional.

    Attributes:
        table: name of the table that takes it.
        is_point: progress counts it, and front ends are shown it as it comes.
        point_name: of a point, what one is called in counts.
        target_column: of a point, the column that names what it was measured at; empty for none.
        segment_column: of a point, the column with the number of the count that it belongs to; empty for none.
        extra: what belongs to this record alone.
    """

    table: ClassVar[str]
    is_point: ClassVar[bool] = False
    point_name: ClassVar[str] = "distance"
    target_column: ClassVar[str] = ""
    segment_column: ClassVar[str] = ""
    extra: Row = field(default_factory=dict)


@dataclass(frozen=True, kw_only=True)
class Observation(Record):
    """Base of what is observed now and then: all kinds share one table, with their fields in `extra`.

    Attributes:
        kind: what was observed.
        change: name of the value that says by how much a length has changed, and its unit in µm; empty for none.
    """

    table: ClassVar[str] = "records"
    kind: ClassVar[str]
    change: ClassVar[tuple[str, float]] = ("", 1.0)

    @classmethod
    def describe(cls, row: Row) -> str:
        """Return a stored one as a sentence; empty for its values by their names.

        Args:
            row: an older program may have stored fewer values, or others.
        """
        del row
        return ""

    @classmethod
    def summary(cls, rows: Sequence[Row]) -> list[str]:
        """Return what all that a run has stored come to, in texts: how often, and the largest change.

        Args:
            rows: in order, at least one.
        """
        changes = [change for row in rows if (change := cls._change_um(row)) is not None]
        largest = f", largest change {max(changes, key=abs):+.1f} µm" if changes else ""
        return [f"{len(rows)}×{largest}"]

    @classmethod
    def _change_um(cls, row: Row) -> float | None:
        name, um = cls.change
        value = row.get(name)
        return value * um if isinstance(value, int | float) else None


OBSERVATIONS: Final = Table("records", (Column("kind", "TEXT", required=True),))
"""The table of observations."""


def table_of(record: type[Record]) -> Table:
    """Return the table that takes a type of records.

    Raises:
        TypeError: a field is no column.
        ValueError: a name cannot be used.
    """
    if issubclass(record, Observation):
        return OBSERVATIONS
    return _own_table(record)  # type: ignore[arg-type]  # mypy judges the class by its instances, which have no hash


def tables_of(records: Iterable[type[Record]]) -> tuple[Table, ...]:
    """Return the tables that take types of records, each once, in their order."""
    return tuple(dict.fromkeys(map(table_of, records)))


def row_of(record: Record) -> Row:
    """Return the values of a record by name.

    Raises:
        ValueError: a further value has the name of a column, and would hide what stands there.
    """
    own = {each.name: getattr(record, each.name) for each in fields(record) if each.name != EXTRA}
    if isinstance(record, Observation):
        own = {"kind": record.kind, **own}
    if hidden := record.extra.keys() & {*own, *_TAKEN}:
        raise ValueError(
            f"{type(record).__name__}: extra has {', '.join(sorted(hidden))}, which columns are called"
        )
    return {**own, **record.extra}


# Each record that is handed over asks for it, and annotations are slow to read.
@cache
def _own_table(record: type[Record]) -> Table:
    hints = get_type_hints(record)
    own = [each.name for each in fields(record) if each.name != EXTRA]
    return Table(record.table, tuple(_column(name, hints[name]) for name in own))


def _column(name: str, hint: Any) -> Column:
    options = get_args(hint) if get_origin(hint) is UnionType else (hint,)
    kinds = [_KINDS[option] for option in options if option in _KINDS]
    if len(kinds) != 1 or len(options) != 1 + (NoneType in options):
        raise TypeError(f"{name}: {hint} is not a column; use float, int or str, optionally with | None")
    return Column(name, kinds[0], required=NoneType not in options)
