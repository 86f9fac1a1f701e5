"""What becomes of an event about the bench that was not sent before the next one of its kind came."""

from catseye.app.protocol.engine_events import BenchSeen, SamplesTaken, WirePassed
from catseye.app.protocol.events import AnyEvent
from catseye.app.service.watching.columns import MOST_COLUMNS
from catseye.app.service.watching.traffic import MOST_LINES


def merged(older: AnyEvent, newer: AnyEvent) -> AnyEvent:
    """Return the event that is sent in place of two of the same kind; what is left out is counted."""
    match older, newer:
        case BenchSeen(), BenchSeen():
            return newer.model_copy(update={"missed": older.missed + 1 + newer.missed})
        case SamplesTaken(), SamplesTaken():
            surplus = max(0, len(older.count) + len(newer.count) - MOST_COLUMNS)
            columns = {
                "low": (older.low + newer.low)[surplus:],
                "high": (older.high + newer.high)[surplus:],
                "count": (older.count + newer.count)[surplus:],
            }
            return newer.model_copy(update={**columns, "missed": older.missed + newer.missed + surplus})
        case WirePassed(), WirePassed():
            lines = older.lines + newer.lines
            surplus = max(0, len(lines) - MOST_LINES)
            missed = older.missed + newer.missed + surplus
            return newer.model_copy(update={"lines": lines[surplus:], "missed": missed})
    return newer
