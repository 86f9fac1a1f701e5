"""Where a report comes from."""

from collections.abc import Sequence
from datetime import UTC, datetime

from catseye.app.results.model import Origin
from catseye.app.store.software import SOFTWARE


def now_utc() -> str:
    """Return the time, ISO 8601 UTC to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def origin_now(*, simulated: bool = False, unverified: Sequence[str] = ()) -> Origin:
    """Return the origin of a report that is made now."""
    return Origin(SOFTWARE, now_utc(), simulated, tuple(unverified))


def joined(origins: Sequence[Origin]) -> Origin:
    """Return the origin of a report that is made now of several sources: what marks one of them marks it."""
    unverified = dict.fromkeys(text for one in origins for text in one.unverified)
    return origin_now(simulated=any(one.simulated for one in origins), unverified=tuple(unverified))
