"""Colours and markers by what they stand for; the style sheet takes its colours from here.

Textual has themes, which a user may change: on a screen a role names a colour of the theme.
"""

from dataclasses import dataclass
from typing import Final

from catseye.app.results.figures import Ink, Role


@dataclass(frozen=True)
class Look:
    """How marks of a role are drawn.

    Attributes:
        colour: of lines, markers and outlines.
        theme: name of the colour in Textual's themes.
        marker: of single points, by its name in matplotlib.
        face: inside of a marker or a filled shape; empty for the colour itself.
        dash: of a line that joins markers, by its name in matplotlib: print may have greys only.
    """

    colour: str
    theme: str
    marker: str = "o"
    face: str = ""
    dash: str | tuple[int, tuple[float, ...]] = "-"


RED: Final = "#c62828"
BLUE: Final = "#1556b0"
GREEN: Final = "#1b7f3b"

ROLES: Final = {
    Role.POSITIVE: Look(RED, "primary", "^"),
    Role.NEGATIVE: Look(BLUE, "accent", "v"),
    Role.CONVENTIONAL: Look(GREEN, "secondary"),
    Role.REVERSAL: Look("#5b3a8c", "secondary"),
    Role.TRUTH: Look("#222222", "foreground", "."),
    Role.COMMAND: Look("#3c4148", "foreground", "."),
    Role.SCATTER: Look("#b9c4d2", "foreground-muted", "."),
    Role.QUANTILE: Look("#35608f", "primary", "."),
    Role.EXPECTED: Look("#c9b458", "warning"),
    Role.AXIS: Look("#5f6670", "foreground-muted"),
    Role.CHANGE: Look(RED, "error", "D"),
    Role.CHOSEN: Look(RED, "error"),
    Role.BEAM: Look("#e00000", "success"),
    Role.ARM: Look("#59636e", "foreground", "o", "white"),
    Role.COLUMN: Look("#8a8f98", "foreground-muted", "o", "#d7dbe0"),
    Role.MUTED: Look("#8a8f98", "foreground-muted"),
    Role.PATH: Look("#9aa0a8", "foreground-muted"),
    Role.ABOVE: Look("#b35806", "accent", "^"),
    Role.BELOW: Look("#542788", "primary", "v"),
    Role.REGION: Look("#0a3d91", "primary"),
}

SERIES: Final = (
    Look("#d55e00", "accent", "o"),
    Look("#0072b2", "primary", "s", dash="--"),
    Look("#8e44ad", "secondary", "^", dash="-."),
    Look("#00806a", "success", "D", dash=":"),
    Look("#8c6d1f", "warning", "v", dash=(0, (8.0, 2.0))),
    Look("#444444", "foreground", "P", dash=(0, (6.0, 1.5, 1.0, 1.5, 1.0, 1.5))),
)
"""Reflectors in turn."""

SPANS: Final = (("#e4e8ed", ""), ("#eef0e6", "////"), ("#f4e9e4", "...."))
"""Colour and hatch of the kinds of stretches in one figure."""

SPAN_HATCH: Final = "#aab2bd"
NOTE: Final = "#33383e"


def look_of(ink: Ink) -> Look:
    """Return how a role, or a reflector by its place, is drawn."""
    return SERIES[ink % len(SERIES)] if isinstance(ink, int) else ROLES[ink]
