"""What becomes of a message about the bench that was not sent before the next one of its kind came."""

from collections.abc import Callable
from typing import Any

from catseye.app.service.messages import Message
from catseye.app.service.watching.columns import MOST_COLUMNS
from catseye.app.service.watching.traffic import MOST_LINES

_COLUMN_LISTS = ("low", "high", "count")


def merged(older: Message, newer: Message) -> Message:
    """Return the message that is sent in place of two of the same kind; neither is changed."""
    merge = MERGED.get(str(newer.get("event")))
    return newer if merge is None else merge(older, newer)


def _benches(older: Message, newer: Message) -> Message:
    """Return the newer bench; the older one is counted."""
    return {**newer, "missed": _missed(older) + 1 + _missed(newer)}


def _samples(older: Message, newer: Message) -> Message:
    """Return the columns of both; the oldest ones are left out and counted when they are too many."""
    lists = {name: [*_list(older, name), *_list(newer, name)] for name in _COLUMN_LISTS}
    surplus = max(0, len(lists["count"]) - MOST_COLUMNS)
    kept = {name: values[surplus:] for name, values in lists.items()}
    return {**newer, **kept, "missed": _missed(older) + _missed(newer) + surplus}


def _lines(older: Message, newer: Message) -> Message:
    """Return the lines of both; the oldest ones are left out and counted when they are too many."""
    lines = [*_list(older, "lines"), *_list(newer, "lines")]
    surplus = max(0, len(lines) - MOST_LINES)
    return {**newer, "lines": lines[surplus:], "missed": _missed(older) + _missed(newer) + surplus}


def _list(message: Message, name: str) -> list[Any]:
    values = message.get(name)
    return values if isinstance(values, list) else []


def _missed(message: Message) -> int:
    missed = message.get("missed")
    return missed if isinstance(missed, int) else 0


MERGED: dict[str, Callable[[Message, Message], Message]] = {
    "bench": _benches,
    "samples": _samples,
    "wire": _lines,
}
"""How two messages of a kind become one, by their event."""
