"""Values of a stored step's result."""

import math

from catseye.procedures.kit.records import Row


def integer(value: object) -> int:
    """Return a whole number.

    Raises:
        TypeError: it is none.
    """
    if isinstance(value, int) and not isinstance(value, bool):
        return value
    if isinstance(value, float) and value.is_integer():
        return int(value)
    raise TypeError(f"a stored step result holds {value!r} where a whole number belongs")


def number(value: object) -> float:
    """Return a finite number.

    Raises:
        TypeError: it is none.
    """
    if isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value):
        return float(value)
    raise TypeError(f"a stored step result holds {value!r} where a number belongs")


def number_of(row: Row, key: str) -> float:
    """Return a number of a result by its key; see `number`."""
    return number(row[key])


def numbers_of(row: Row, key: str) -> list[float]:
    """Return a list of numbers of a result by its key.

    Raises:
        TypeError: it is none.
    """
    values = row[key]
    if not isinstance(values, list):
        raise TypeError(f"a stored step result holds {values!r} where a list of numbers belongs")
    return [number(value) for value in values]


def rows_of(row: Row, key: str) -> list[Row]:
    """Return a list of rows of a result by its key.

    Raises:
        TypeError: it is none.
    """
    values = row[key]
    if not isinstance(values, list):
        raise TypeError(f"a stored step result holds {values!r} where rows belong")
    rows: list[Row] = []
    for value in values:
        if not isinstance(value, dict):
            raise TypeError(f"a stored step result holds {value!r} where a row belongs")
        rows.append(value)
    return rows
