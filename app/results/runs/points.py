"""The points of a run, as far as its summary and its timeline speak of them."""

from collections.abc import Iterable
from dataclasses import dataclass

from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import Record


@dataclass(frozen=True)
class Point:
    """A stored point.

    Attributes:
        step_id: step that has measured it.
        target: what it was measured at; empty for nothing in particular.
        segment: of the count that it belongs to; None where nothing is counted.
    """

    step_id: str
    target: str
    segment: int | None


def points_of(reader: RunReader, types: Iterable[type[Record]]) -> list[Point]:
    """Return the points of a run in the order of their tables."""
    return [
        Point(
            str(row["step_id"]),
            str(row.get(kind.target_column) or ""),
            segment if isinstance(segment := row.get(kind.segment_column), int) else None,
        )
        for kind in types
        if kind.is_point
        for row in reader.rows(kind.table)
    ]
