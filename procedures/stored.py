"""Values out of the stored results of steps: they were JSON in between."""

from procedures.context import Json, Row


def number_of(row: Row, key: str) -> float:
    """Return a number of a step's result.

    Raises:
        TypeError: it is none.
    """
    return _number(row[key])


def numbers_of(row: Row, key: str) -> list[float]:
    """Return a list of numbers of a step's result.

    Raises:
        TypeError: it is none.
    """
    values = row[key]
    if not isinstance(values, list):
        raise TypeError(f"a stored step result holds {values!r} where a list of numbers belongs")
    return [_number(value) for value in values]


def _number(value: Json) -> float:
    if isinstance(value, (int, float)):
        return float(value)
    raise TypeError(f"a stored step result holds {value!r} where a number belongs")
