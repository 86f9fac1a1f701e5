"""What a declared table may hold, applied to arrays and to the names of a header."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from catseye.calibration.core.types import Floats
from catseye.procedures.kit.columns import ColumnRule, Columns, TableRule

LARGEST_INTEGER = 2**53
"""Every format keeps integers up to this one exactly."""

LARGEST_NUMBER = 1e30
"""No measurement comes near; products of a few such numbers are still numbers."""

Form = tuple[ColumnRule, ...]


def first_fault(form: Form, block: Columns) -> tuple[int, ColumnRule] | None:
    """Return the first row with a value that its rule refuses, and the first such column in it; None for none."""
    faults = [
        (int(np.argmin(sound)), place)
        for place, column in enumerate(form)
        if column.name in block and not (sound := _sound(column, block[column.name])).all()
    ]
    if not faults:
        return None
    row, place = min(faults)
    return row, form[place]


def _sound(column: ColumnRule, values: Floats) -> NDArray[np.bool_]:
    match column.kind:
        case "name":
            sound = values >= 0.0
        case "direction":
            sound = np.abs(values) == 1.0
        case "integer":
            sound = (np.abs(values) <= LARGEST_INTEGER) & (np.floor(values) == values)
        case "number":
            sound = np.abs(values) <= LARGEST_NUMBER
    if column.positive:
        sound &= values > 0.0
    if column.largest is not None:
        sound &= np.abs(values) <= column.largest
    return sound


def form_of(table: TableRule, header: Sequence[str]) -> Form:
    """Return the form that a header has the first columns of; the last form if it has none."""
    return next((form for form in table.forms if set(_own(table, form)) & set(header)), table.forms[-1])


def _own(table: TableRule, form: Form) -> list[str]:
    """Return the names of a form that no other form has."""
    others = {column.name for other in table.forms if other is not form for column in other}
    return [column.name for column in form if column.name not in others]


def header_fault(table: TableRule, header: Sequence[str]) -> str:
    """Return what is wrong with the names of a header; empty when nothing is."""
    for name, text in table.misplaced:
        if name in header:
            return text
    own = [_own(table, form) for form in table.forms]
    if sum(any(name in header for name in names) for names in own) > 1:
        return f"{table.mixed}; keep either {' or '.join(','.join(names) for names in own)}"
    form = form_of(table, header)
    missing = [column for column in form if not column.optional and column.name not in header]
    if missing:
        names = [column.name for column in missing]
        return f"column {', '.join(names)} is missing{_alike(names, header)}{_remedy(table, missing)}"
    if fault := doubled_fault(form if table.source else None, header):
        return f"{fault}; allowed are {forms_text(table)}"
    if table.source:
        return ""
    if unknown := [name for name in header if name not in {column.name for column in form}]:
        return f"unknown column {', '.join(unknown)}; allowed are {forms_text(table)}"
    return ""


def doubled_fault(form: Form | None, header: Sequence[str]) -> str:
    """Return which columns stand twice; empty when none does.

    Args:
        form: rules of the columns that are looked at; None looks at all of the header.
        header: names of the columns.
    """
    wanted = set(header) if form is None else {column.name for column in form}
    doubled = sorted(name for name in wanted if header.count(name) > 1)
    return f"column {', '.join(doubled)} stands twice" if doubled else ""


def _alike(missing: Sequence[str], header: Sequence[str]) -> str:
    """Return which columns are called almost like missing ones, in other letters or with another unit."""
    stems = {name.lower().rpartition("_")[0] for name in missing} - {""}
    alike = [name for name in header if name.lower() in missing or name.lower().rpartition("_")[0] in stems]
    return f" (the file has {', '.join(alike)}: another spelling or unit)" if alike else ""


def _remedy(table: TableRule, missing: Sequence[ColumnRule]) -> str:
    if table.source:
        return f": it takes {table.source}"
    reasons = {column.needed for column in missing}
    why = f"{reason}; " if len(reasons) == 1 and (reason := reasons.pop()) else ""
    return f"; {why}the header has to be {forms_text(table)}, comma separated"


def forms_text(table: TableRule) -> str:
    """Return the headers that a file may have, optional columns in brackets."""
    return " or ".join(
        ",".join(column.name for column in form if not column.optional)
        + "".join(f"[,{column.name}]" for column in form if column.optional)
        for form in table.forms
    )


def places_among(found: NDArray[np.str_], names: Sequence[str]) -> Floats:
    """Return where each name stands among the known ones, -1 for an unknown one."""
    places = np.full(found.size, -1.0)
    for place, name in enumerate(names):
        places[found == name] = place
    return places
