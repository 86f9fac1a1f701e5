"""Drawings and lines in the colours of the theme."""

from collections.abc import Iterable, Mapping
from typing import Final

from textual.content import Content

from catseye.app.render.palette import ROLES, SERIES
from catseye.app.results.figures import Ink

Line = list[tuple[str, str]]
"""Pieces of text with their ink."""

_PLACES: Final = {str(place): look for place, look in enumerate(SERIES)}
_LOOKS: Final = {**{role.value: look for role, look in ROLES.items()}, **_PLACES}
FIGURE_STYLES: Final = {
    **{name: f"${look.theme} bold" for name, look in _LOOKS.items()},
    **{f"faint {name}": f"${look.theme}" for name, look in _LOOKS.items()},
    "axis": "$foreground-muted",
    "heat": "$warning",
}
"""Style of each ink of a figure."""


def ink_name(ink: Ink | str, *, faint: bool = False) -> str:
    """Return the ink of a role or of a reflector by its place."""
    name = str(ink % len(SERIES)) if isinstance(ink, int) else str(ink)
    return f"faint {name}" if faint else name


def painted(lines: Iterable[Line], styles: Mapping[str, str], *, faded: bool = False) -> Content:
    """Return lines in their colours.

    Args:
        styles: style of each ink; others are plain.
        faded: everything is dim: it is old.
    """
    pieces: list[tuple[str, str] | str] = []
    for number, line in enumerate(lines):
        if number:
            pieces.append("\n")
        pieces.extend((text, "dim" if faded and text.strip() else styles.get(ink, "")) for text, ink in line)
    return Content.assemble(*pieces)
