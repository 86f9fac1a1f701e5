"""What was observed beside the distances, as sentences."""

from collections.abc import Iterable

from catseye.procedures.kit.event_text import plain_text
from catseye.procedures.kit.records import EXTRA, KEY, Observation, Record, Row


def record_text(row: Row, records: Iterable[type[Record]]) -> str:
    """Return an observation as a sentence.

    Args:
        records: types that the run's procedure declares.
    """
    own = {key: value for key, value in row.items() if key not in {*KEY, EXTRA, "kind"}}
    kind = str(row["kind"])
    known = (record for record in records if issubclass(record, Observation) and record.kind == kind)
    declared = next(known, None)
    return (declared.describe(own) if declared else "") or plain_text(kind, own)
