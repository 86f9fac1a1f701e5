"""Colours and markers of pages and figures by what they stand for; the style sheet takes its colours from here.

Textual has themes of its own, which a user may change: there a role names a colour of the theme.
"""

from dataclasses import dataclass
from typing import Final

from catseye.app.results.figures import Ink, Role


@dataclass(frozen=True)
class Look:
    """How marks of a role are drawn.

    Attributes:
        colour: of lines, markers and outlines.
        marker: of single points.
        face: inside of a marker or a filled shape; empty for the colour itself.
    """

    colour: str
    marker: str = "o"
    face: str = ""


RED: Final = "#c62828"
BLUE: Final = "#1556b0"
GREEN: Final = "#1b7f3b"

ROLES: Final = {
    Role.POSITIVE: Look(RED, "^"),
    Role.NEGATIVE: Look(BLUE, "v"),
    Role.CONVENTIONAL: Look(GREEN),
    Role.REVERSAL: Look("#5b3a8c"),
    Role.TRUTH: Look("#222222", "."),
    Role.COMMAND: Look("#3c4148", "."),
    Role.SCATTER: Look("#b9c4d2", "."),
    Role.QUANTILE: Look("#35608f", "."),
    Role.EXPECTED: Look("#c9b458"),
    Role.AXIS: Look("#5f6670"),
    Role.CHANGE: Look(RED, "D"),
    Role.CHOSEN: Look(RED),
    Role.BEAM: Look("#e00000"),
    Role.ARM: Look("#59636e", "o", "white"),
    Role.COLUMN: Look("#8a8f98", "o", "#d7dbe0"),
    Role.MUTED: Look("#8a8f98"),
    Role.PATH: Look("#9aa0a8"),
    Role.ABOVE: Look("#b35806", "^"),
    Role.BELOW: Look("#542788", "v"),
    Role.REGION: Look("#0a3d91"),
}

SERIES: Final = (
    Look("#d55e00", "o"),
    Look("#0072b2", "s"),
    Look("#8e44ad", "^"),
    Look("#00806a", "D"),
    Look("#8c6d1f", "v"),
    Look("#444444", "P"),
)
"""Reflectors in turn."""

SPAN: Final = "#e4e8ed"
NOTE: Final = "#33383e"


def look_of(ink: Ink) -> Look:
    """Return how a role, or a reflector by its place, is drawn."""
    return SERIES[ink % len(SERIES)] if isinstance(ink, int) else ROLES[ink]
