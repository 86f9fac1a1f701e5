"""A serial arm from the side and from above."""

from typing import Final

from textual.geometry import Size

from catseye.app.protocol.posture import Posture
from catseye.app.tui.serial.posture_drawing import draw_posture, views_of
from catseye.app.tui.widgets.inks import painted
from catseye.app.tui.widgets.picture import Picture, Seen

_STYLES: Final = {
    "body": "dim",
    "arm": "$primary bold",
    "moving": "$warning bold",
    "tool": "$accent bold",
    "floor": "dim",
    "word": "dim",
}


def posture_picture(posture: Posture, seen: Seen, size: Size) -> Picture:
    """Return an arm as it stands."""
    moving = _place(seen)
    title = "From the side, from above" if views_of(size.width, size.height) > 1 else "From the side"
    lines = draw_posture(posture, moving, size.width, size.height)
    if seen.stale:
        caption = "arm as it was: old"
    elif moving is not None:
        caption = f"● {seen.names[moving]} moves"
    else:
        caption = "○ joints  ◎ flange"
    return Picture(title, painted(lines, _STYLES, faded=seen.stale), caption)


def _place(seen: Seen) -> int | None:
    """Return the number of the axis that is moved by hand, from 0."""
    names = [name.lower() for name in seen.names]
    return names.index(seen.moving) if seen.moving in names else None
