"""What a procedure hands over to be kept, checked where it is handed over."""

from collections.abc import Collection, Iterable

from catseye.app.store.rows import encode
from catseye.procedures.kit.records import Record, Row, row_of, table_of


def require_recordable(record: Record, declared: Collection[type[Record]], *, in_step: bool) -> None:
    """Check that a record can become durable.

    Raises:
        RuntimeError: no step is under way, or the procedure does not declare this type of records.
        ValueError: it does not fit its table.
    """
    kind = type(record)
    if not in_step:
        raise RuntimeError(
            f"a row for {kind.table} was recorded outside of a step; it could not become durable"
        )
    if kind not in declared:
        raise RuntimeError(f"the procedure records a {kind.__name__}, which it does not declare")
    encode(table_of(kind), row_of(record))


def rows_of(records: Iterable[Record]) -> list[tuple[str, Row]]:
    """Return records as the store takes them: each a row with the name of its table."""
    return [(record.table, row_of(record)) for record in records]
