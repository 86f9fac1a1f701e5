"""The distances of a run that identification uses: its points, and the returns to poses measured before."""

from dataclasses import fields
from operator import itemgetter
from typing import Final

from catseye.app.store.reader import RunReader
from catseye.procedures.kit.records import OBSERVATIONS, Json, table_of
from catseye.procedures.scara.records import ClosureVisit, Distance

_OF_VISIT: Final = {"kind", *(each.name for each in fields(ClosureVisit))}
_REQUIRED: Final = table_of(Distance).required


def measured_distances(reader: RunReader) -> list[dict[str, Json]]:
    """Return points and returns in measuring order; a return has the columns of a point, and `returned` 1.

    Returns without their whole distance or their place in the journal, which early versions stored, are left out.
    """
    returns = [
        (place, _distance(row))
        for place, row in reader.placed_rows(OBSERVATIONS.name)
        if place and row["kind"] == ClosureVisit.kind and all(row.get(name) is not None for name in _REQUIRED)
    ]
    placed = sorted([*reader.placed_rows(Distance.table), *returns], key=itemgetter(0))
    return [row for _, row in placed]


def _distance(visit: dict[str, Json]) -> dict[str, Json]:
    return {key: value for key, value in visit.items() if key not in _OF_VISIT} | {"returned": 1}
