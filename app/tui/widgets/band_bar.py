"""A value against its acceptance band, as a bar with marks."""

from typing import TYPE_CHECKING, Final

from catseye.procedures.kit.live import in_band

if TYPE_CHECKING:
    # The first screen is painted before this is imported.
    from catseye.app.protocol.run_events import LiveData

_ROOM: Final = 0.35
"""Room on either side of a band, as a share of its width."""


def band_text(low: float | None, high: float | None, unit: str) -> str:
    """Return what is accepted, in words."""
    if low is not None and high is not None:
        if low == -high:
            return f"±{high:.4g} {unit}".strip()
        return f"{low:.4g} … {high:.4g} {unit}".strip()
    if low is not None:
        return f"at least {low:.4g} {unit}".strip()
    return "" if high is None else f"at most {high:.4g} {unit}".strip()


def band_bar(live: "LiveData", width: int) -> str:
    """Return a bar: the band between its marks, the value on it; an arrow where the value lies outside the bar.

    Args:
        width: in characters.
    """
    low, high = _ends(live)
    if width < 8 or high <= low:
        return ""

    def place(value: float) -> int:
        return round((value - low) / (high - low) * (width - 1))

    cells = [
        "░" if in_band(low + (high - low) * number / (width - 1), live.low, live.high) else "─"
        for number in range(width)
    ]
    for limit in (live.low, live.high):
        if limit is not None:
            cells[place(limit)] = "┃"
    at = place(live.value)
    cells[min(max(at, 0), width - 1)] = "◀" if at < 0 else "▶" if at >= width else "●"
    return "".join(cells)


def value_text(value: float) -> str:
    """Return a live value with as many digits as a person reads at a glance."""
    size = abs(value)
    digits = 3 if size < 1.0 else 2 if size < 100.0 else 1
    return f"{value:.{digits}f}"


def _ends(live: "LiveData") -> tuple[float, float]:
    if live.low is not None and live.high is not None:
        room = _ROOM * (live.high - live.low)
        return live.low - room, live.high + room
    if live.low is not None:
        reach = max(abs(live.low), abs(live.value), 1e-9)
        return live.low - reach, live.low + reach
    if live.high is not None:
        return min(0.0, live.value), max(live.high * (1.0 + _ROOM), live.high + 1e-9)
    return live.value, live.value
