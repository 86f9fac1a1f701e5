"""Runs as rows of a table: what each column says, and the words a row is found by."""

from typing import TYPE_CHECKING, Final

from rich.text import Text

from catseye.app.results.numbers import clock_text

if TYPE_CHECKING:
    # The first screen is painted before the store is imported.
    from catseye.app.store.history import RunLine

STATES: Final = {
    "complete": ("✓", "green"),
    "stopped": ("■", "yellow"),
    "aborted": ("✗", "bold red"),
    "failed": ("✗", "bold red"),
    "running": ("▶", "bold cyan"),
    "died": ("†", "bold red"),
    "damaged": ("!", "bold red"),
}
"""Sign and style of each state."""

MARK: Final = "●"

_WIDTHS: Final = {
    "mark": 1,
    "started UTC": 11,
    "procedure": 16,
    "state": 10,
    "h:min:s": 8,
    "points": 6,
    "sim": 3,
    "cell": 8,
    "id": 6,
}
_WIDE_STARTED: Final = 16
_WIDE_CELL: Final = 24


def columns(*, wide: bool) -> list[tuple[str, int]]:
    """Return name and width of each column; a cell of blank between two is part of the width."""
    return [(name, width + 1) for name, width in _widths(wide=wide).items()]


def _widths(*, wide: bool) -> dict[str, int]:
    return _WIDTHS | ({"started UTC": _WIDE_STARTED, "cell": _WIDE_CELL} if wide else {})


def _cut(text: str, width: int) -> Text:
    """Return a text that leaves the blank to the next column."""
    return Text(text if len(text) <= width else f"{text[: width - 1]}…")


def cells(line: "RunLine", *, marked: bool, wide: bool) -> list[Text]:
    """Return what the row of a run says."""
    sign, style = STATES[line.status]
    widths = _widths(wide=wide)
    when = f"{line.started_utc:%Y-%m-%d %H:%M}"
    return [
        Text(MARK if marked else " ", "bold cyan"),
        Text(when if wide else when[5:]),
        _cut(line.procedure, widths["procedure"]),
        Text(f"{sign} {line.status}", style),
        Text(f"{clock_text(line.duration_s):>8}"),
        Text(f"{line.rows or '':>6}"),
        Text({True: "SIM", False: "", None: "?"}[line.simulated], "yellow"),
        _cut(line.cell, widths["cell"]),
        Text(line.id, "dim"),
    ]


def searched_words(line: "RunLine") -> str:
    """Return the words by which a run is found: those of its row, and whether it is simulated or real."""
    simulated = {True: "simulated", False: "real", None: ""}[line.simulated]
    return f"{line.name} {line.started_utc:%Y-%m-%d} {line.status} {line.cell} {simulated}"
