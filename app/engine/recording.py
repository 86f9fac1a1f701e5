"""What a procedure hands over to be kept, checked where it is handed over."""

from collections.abc import Collection, Iterable, Mapping

from catseye.app.store.rows import encode, to_json, type_name
from catseye.procedures.kit.records import Record, Row, row_of, table_of


def require_recordable(record: Record, declared: Collection[type[Record]], *, in_step: bool) -> None:
    """Check that a record can become durable.

    Raises:
        RuntimeError: no step is under way, or the procedure does not declare this type of records.
        ValueError: it does not fit its table.
    """
    kind = type(record)
    if not isinstance(record, Record):
        raise RuntimeError(
            f"{record!r} is a {type_name(record)}: only a Record that the procedure declares is kept"
        )
    if not in_step:
        raise RuntimeError(
            f"a row for {kind.table} was recorded outside of a step; it could not become durable"
        )
    if kind not in declared:
        raise RuntimeError(
            f"the procedure records a {kind.__name__}, which it does not declare: name it in `records`, for the "
            f"table {kind.table}"
        )
    try:
        encode(table_of(kind), row_of(record))
    except ValueError as error:
        raise ValueError(f"a {kind.__name__} cannot be kept: {error}") from None


def require_result(step_id: str, result: Row) -> None:
    """Check that the result of a step can be read back when the run is resumed.

    Raises:
        ValueError: it is no mapping, or JSON cannot carry a value of it.
    """
    if not isinstance(result, Mapping):
        raise ValueError(
            f"step {step_id} returned {result!r}, a {type_name(result)}: it has to return a dict, {{}} for nothing"
        )
    try:
        to_json(result)
    except ValueError as error:
        raise ValueError(f"the result of step {step_id} cannot be kept: {error}") from None


def rows_of(records: Iterable[Record]) -> list[tuple[str, Row]]:
    """Return records as the store takes them: each a row with the name of its table."""
    return [(record.table, row_of(record)) for record in records]
